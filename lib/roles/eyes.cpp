#include "roles/roles.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "roles/joint_names.h"

namespace krok {

namespace {

constexpr std::array<std::string_view, 2> kEye = {"eye", "eyeball"};
constexpr std::array<std::string_view, 4> kLeft = {"l", "left", "lft", "lt"};
constexpr std::array<std::string_view, 4> kRight = {"r", "right", "rgt", "rt"};
constexpr std::array<std::string_view, 16> kNotTheEye = {
    "lid",  "lids", "brow", "brows",  "lash", "lashes",  "socket", "corner",
    "look", "aim",  "goal", "target", "ctrl", "control", "end",    "nub"};

template <std::size_t kCount>
bool is_in(const std::array<std::string_view, kCount>& words, const std::string& token) {
  return std::ranges::find(words, token) != words.end();
}

}  // namespace

EyeJoints find_eyes(const Skeleton& skeleton) {
  EyeJoints eyes;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    bool eye = false, left = false, right = false, other = false;
    for (const std::string& token : name_tokens(skeleton.names[static_cast<std::size_t>(j)])) {
      eye = eye || is_in(kEye, token);
      left = left || is_in(kLeft, token);
      right = right || is_in(kRight, token);
      other = other || is_in(kNotTheEye, token);
    }
    if (!eye || other || left == right) continue;
    int& place = left ? eyes.left : eyes.right;
    if (place < 0) place = j;
  }
  return eyes;
}

}  // namespace krok
