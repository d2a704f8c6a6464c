#include "roles/role_finder_internal.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "roles/joint_names.h"
#include "roles/roles.h"

namespace krok {

NamedJoints::NamedJoints(const Skeleton& skeleton, std::vector<JointName> names)
    : skeleton_(skeleton), names_(std::move(names)), children_(skeleton.children()) {
  const std::size_t count = skeleton.names.size();
  depths_.assign(count, 0);
  counts_below_.assign(count, 1);
  for (std::size_t j = 1; j < count; ++j) depths_[j] = depths_[at(skeleton.parents[j])] + 1;
  for (std::size_t j = count; j-- > 1;) {
    counts_below_[at(skeleton.parents[j])] += counts_below_[j];
  }
}

bool NamedJoints::descends(int joint, int ancestor) const {
  while (joint >= 0 && depths_[at(joint)] > depths_[at(ancestor)]) joint = parent(joint);
  return joint == ancestor;
}

int NamedJoints::common_ancestor(int a, int b) const {
  if (a < 0 || b < 0) return std::max(a, b);
  while (a != b) {
    if (depths_[at(a)] >= depths_[at(b)]) {
      a = parent(a);
    } else {
      b = parent(b);
    }
  }
  return a;
}

double NamedJoints::distance(int a, int b) const {
  return (skeleton_.reference[at(a)].position - skeleton_.reference[at(b)].position).norm();
}

int NamedJoints::main_child(int joint) const {
  int best = -1;
  for (const int child : children_[at(joint)]) {
    if (is_end(child) || is_helper(child)) continue;
    if (best < 0 || counts_below_[at(child)] > counts_below_[at(best)]) best = child;
  }
  return best;
}

namespace {

// Whether an ancestor of `joint` on `side` is named as one of `parts`.
bool hangs_under(const NamedJoints& joints, int joint, Side side, std::span<const Part> parts) {
  for (int j = joints.parent(joint); j >= 0; j = joints.parent(j)) {
    if (joints.side(j) == side &&
        std::find(parts.begin(), parts.end(), joints.part(j)) != parts.end()) {
      return true;
    }
  }
  return false;
}

// The end joint of a limb: a joint named `tip` below a joint of that limb, else the main child of
// the limb's last part, else a joint named `tip` anywhere.
int find_tip(const NamedJoints& joints, Side side, Part tip, std::span<const Part> limb) {
  const auto named = [&](int j) { return joints.part(j) == tip && joints.side(j) == side; };
  int found = joints.nearest([&](int j) { return named(j) && hangs_under(joints, j, side, limb); });
  if (found >= 0) return found;
  const int last = joints.nearest(
      [&](int j) { return joints.part(j) == limb.back() && joints.side(j) == side; });
  if (last >= 0) return joints.main_child(last);
  return joints.nearest(named);
}

// If both arms and legs are known by name, but no neck or head (only numbered vertebrae, for
// example): the last joint of the single branch above the arms.
int unnamed_head(const NamedJoints& joints, const LimbTips& tips) {
  if (tips.hands[0] < 0 || tips.hands[1] < 0 || tips.feet[0] < 0 || tips.feet[1] < 0) return -1;
  const auto may_lead_on = [&](int j) {
    const bool named = joints.part(j) != Part::unknown && joints.part(j) != Part::spine;
    return !joints.is_end(j) && !named && joints.side(j) == Side::middle;
  };
  const int chest = joints.common_ancestor(tips.hands[0], tips.hands[1]);
  if (joints.descends(tips.feet[0], chest)) return -1;  // all limbs on one joint: up is unknown
  // A vertebra rather than a bow or a scarf.
  std::array<int, 2> found = {0, 0}, heads = {-1, -1};
  for (const int child : joints.children(chest)) {
    if (joints.is_end(child) || joints.descends(tips.hands[0], child) ||
        joints.descends(tips.hands[1], child)) {
      continue;
    }
    const std::size_t kind = may_lead_on(child) && joints.part(child) == Part::spine ? 0 : 1;
    found[kind] += may_lead_on(child) ? 1 : 2;
    heads[kind] = child;
  }
  int head = found[0] == 1 ? heads[0] : found[0] == 0 && found[1] == 1 ? heads[1] : -1;
  while (head >= 0 && joints.children(head).size() == 1 && may_lead_on(joints.children(head)[0])) {
    head = joints.children(head)[0];
  }
  return head;
}

}  // namespace

LimbTips find_limb_tips(const NamedJoints& joints) {
  constexpr std::array kArm = {Part::collar, Part::shoulder, Part::upper_arm, Part::arm,
                               Part::lower_arm};
  constexpr std::array kLeg = {Part::hip, Part::upper_leg, Part::leg, Part::lower_leg};
  LimbTips tips;
  tips.hands = {find_tip(joints, Side::left, Part::hand, kArm),
                find_tip(joints, Side::right, Part::hand, kArm)};
  tips.feet = {find_tip(joints, Side::left, Part::foot, kLeg),
               find_tip(joints, Side::right, Part::foot, kLeg)};
  tips.head = joints.nearest([&](int j) { return joints.part(j) == Part::head; });
  tips.neck = joints.nearest([&](int j) { return joints.part(j) == Part::neck; });
  if (tips.head < 0 && tips.neck >= 0) {
    int last = tips.neck;
    while (joints.main_child(last) >= 0 && joints.part(joints.main_child(last)) == Part::neck) {
      last = joints.main_child(last);
    }
    tips.head = joints.main_child(last);
    if (tips.head < 0 && last != tips.neck) tips.head = last;  // the last of several necks
  }
  if (tips.head < 0 && tips.neck < 0) tips.head = unnamed_head(joints, tips);
  return tips;
}

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
