#include "scene/character.h"

#include <fmt/format.h>

#include <cmath>
#include <unordered_set>

#include "core/text.h"

namespace krok {

namespace {

Error fault(std::string message) {
  return Error("character-value", std::move(message));
}

// Names must be unique and not empty.
template <typename Item>
Status check_names(const std::vector<Item>& items, const char* what) {
  std::unordered_set<std::string_view> seen;
  for (const Item& item : items) {
    if (!is_name(item.name)) {
      return fault(
          fmt::format("the name of {} is empty, too long, not UTF-8 or has a zero byte", what));
    }
    if (seen.insert(item.name).second) continue;
    return fault(fmt::format("{} '{}' appears twice", what, shown(item.name)));
  }
  return {};
}

}  // namespace

std::string eye_joint_name(const Character::Eye& eye) {
  return eye.name + "_eye";
}

Status check(const Character& character) {
  if (character.model.empty()) return fault("the character has no model");
  if (Status status = check_names(character.parts, "a part"); !status) return status;
  if (Status status = check_names(character.eyes, "an eye"); !status) return status;
  if (Status status = check_names(character.sockets, "a socket"); !status) return status;
  if (Status status = check_names(character.expressions, "an expression"); !status) return status;
  if (!is_utf8(character.name)) return fault("the character's name is not UTF-8");
  for (const Character::Part& part : character.parts) {
    if (is_utf8(part.material)) continue;
    return fault(fmt::format("the material of part '{}' is not UTF-8", shown(part.name)));
  }
  for (const Character::Eye& eye : character.eyes) {
    if (!is_name(eye.joint)) return fault(fmt::format("eye '{}' has no joint", shown(eye.name)));
    for (const float angle : {eye.range.in, eye.range.out, eye.range.up, eye.range.down}) {
      if (angle >= 0 && angle <= 90) continue;
      return fault(fmt::format("the range of eye '{}' is not 0 to 90 degrees", shown(eye.name)));
    }
    // Rejects NaN too.
    if ((eye.position.array().abs() <= Character::kFurthest).all()) continue;
    return fault(fmt::format("eye '{}' is more than {} m from the origin", shown(eye.name),
                             Character::kFurthest));
  }
  for (const Character::Socket& socket : character.sockets) {
    if (!is_name(socket.joint)) {
      return fault(fmt::format("socket '{}' has no joint", shown(socket.name)));
    }
    if ((socket.offset.array().abs() <= Character::kFurthest).all() &&
        std::abs(socket.orientation.norm() - 1) < 1e-4) {
      continue;
    }
    return fault(
        fmt::format("socket '{}' is more than {} m from its joint, or its orientation is "
                    "not a unit quaternion",
                    shown(socket.name), Character::kFurthest));
  }
  for (const Character::Expression& expression : character.expressions) {
    if (!is_utf8(expression.target)) {
      return fault(fmt::format("the target of '{}' is not UTF-8", shown(expression.name)));
    }
    if (std::abs(expression.weight) <= Character::kMaxWeight) continue;
    return fault(fmt::format("the weight of expression '{}' is not within +-{}",
                             shown(expression.name), Character::kMaxWeight));
  }
  if (!character.expressions.empty() && character.morphs.empty()) {
    return fault("the character has expressions but no file with morph targets");
  }
  return {};
}

}  // namespace krok
