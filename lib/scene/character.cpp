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

Status check(const Character& character) {
  if (character.model.empty()) return fault("the character has no model");
  if (Status status = check_names(character.parts, "a part"); !status) return status;
  if (Status status = check_names(character.eyes, "an eye"); !status) return status;
  if (Status status = check_names(character.expressions, "an expression"); !status) return status;
  if (!is_utf8(character.name)) return fault("the character's name is not UTF-8");
  for (const Character::Part& part : character.parts) {
    if (is_utf8(part.material)) continue;
    return fault(fmt::format("the material of part '{}' is not UTF-8", shown(part.name)));
  }
  for (const Character::Eye& eye : character.eyes) {
    if (!is_name(eye.joint)) return fault(fmt::format("eye '{}' has no joint", shown(eye.name)));
    // Rejects NaN too.
    if ((eye.position.array().abs() <= Character::kFurthest).all()) continue;
    return fault(fmt::format("eye '{}' is more than {} m from the origin", shown(eye.name),
                             Character::kFurthest));
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
