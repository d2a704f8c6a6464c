// Role names and queries of RoleMap.

#include <algorithm>
#include <array>
#include <utility>

#include "core/text.h"
#include "roles/roles.h"

namespace krok {

namespace {

constexpr std::array<std::string_view, 27> kRoleNames = {"none",
                                                         "root",
                                                         "hips",
                                                         "spine",
                                                         "chest",
                                                         "neck",
                                                         "head",
                                                         "left_collar",
                                                         "left_upper_arm",
                                                         "left_lower_arm",
                                                         "left_hand",
                                                         "left_fingers",
                                                         "right_collar",
                                                         "right_upper_arm",
                                                         "right_lower_arm",
                                                         "right_hand",
                                                         "right_fingers",
                                                         "left_upper_leg",
                                                         "left_lower_leg",
                                                         "left_foot",
                                                         "left_toes",
                                                         "right_upper_leg",
                                                         "right_lower_leg",
                                                         "right_foot",
                                                         "right_toes",
                                                         "end",
                                                         "helper"};
static_assert(kRoleNames.size() == static_cast<std::size_t>(Role::helper) + 1);

// People name a joint by where it is, roles name it by the part that it turns.
constexpr std::pair<const char*, const char*> kPlaces[] = {
    {"shoulder", "upperarm"}, {"elbow", "lowerarm"}, {"wrist", "hand"},
    {"hip", "upperleg"},      {"knee", "lowerleg"},  {"ankle", "foot"}};

std::string letters_of(std::string_view name) {
  std::string letters = ascii_lower(name);
  std::erase_if(letters, [](char c) { return c == '_' || c == ' '; });
  return letters;
}

}  // namespace

std::string_view role_name(Role role) {
  return kRoleNames[static_cast<std::size_t>(role)];
}

int RoleMap::joint(Role role) const {
  for (std::size_t i = 0; i < roles.size(); ++i) {
    if (roles[i] == role) return static_cast<int>(i);
  }
  return -1;
}

std::optional<Role> parse_role(std::string_view name) {
  std::string wanted = letters_of(name);
  for (const std::string side : {"left", "right"}) {
    if (!wanted.starts_with(side)) continue;
    for (const auto& [place, part] : kPlaces) {
      if (wanted == side + place) wanted = side + part;
    }
  }
  const auto found = std::ranges::find(kRoleNames, wanted, letters_of);
  if (found == kRoleNames.end()) return std::nullopt;
  return static_cast<Role>(found - kRoleNames.begin());
}

int find_joint(const Skeleton& skeleton, const RoleMap& roles, std::string_view name) {
  const int joint = skeleton.find(name);
  if (joint >= 0) return joint;
  const Role role = parse_role(name).value_or(Role::none);
  return role == Role::none ? -1 : roles.joint(role);
}

bool is_role_of_many(Role role) {
  switch (role) {
    case Role::none:
    case Role::root:
    case Role::spine:
    case Role::neck:
    case Role::left_fingers:
    case Role::right_fingers:
    case Role::left_toes:
    case Role::right_toes:
    case Role::end:
    case Role::helper:
      return true;
    default:
      return false;
  }
}

std::vector<int> RoleMap::joints(Role role) const {
  std::vector<int> found;
  for (std::size_t i = 0; i < roles.size(); ++i) {
    if (roles[i] == role) found.push_back(static_cast<int>(i));
  }
  return found;
}

int RoleMap::finger_joint(Role fingers_role, FingerJoint place) const {
  for (std::size_t i = 0; i < fingers.size(); ++i) {
    if (roles[i] == fingers_role && fingers[i] == place) return static_cast<int>(i);
  }
  return -1;
}

std::string role_label(const RoleMap& map, int joint) {
  const auto j = static_cast<std::size_t>(joint);
  const Role role = map.roles[j];
  const bool left = role == Role::left_fingers;
  const bool placed = j < map.fingers.size() && map.fingers[j].finger != Finger::none;
  if (!placed || (!left && role != Role::right_fingers)) return std::string(role_name(role));
  return (left ? "left_" : "right_") + finger_place_name(map.fingers[j]);
}

std::optional<GivenRole> parse_role_label(std::string_view label) {
  const auto whole = parse_role(label);
  if (whole && role_name(*whole) == label) return GivenRole{0, *whole, {}};
  for (const auto& [side, role] :
       {std::pair<std::string_view, Role>{"left_", Role::left_fingers},
        std::pair<std::string_view, Role>{"right_", Role::right_fingers}}) {
    if (!label.starts_with(side)) continue;
    const auto place = parse_finger_joint(label.substr(side.size()));
    if (place) return GivenRole{0, role, *place};
  }
  return std::nullopt;
}

std::vector<Role> missing_roles(const RoleMap& map) {
  std::vector<Role> missing;
  const bool head = map.joint(Role::head) >= 0 || map.joint(Role::neck) >= 0;
  for (const Role role :
       {Role::hips, Role::head, Role::left_upper_arm, Role::left_hand, Role::right_upper_arm,
        Role::right_hand, Role::left_upper_leg, Role::left_lower_leg, Role::left_foot,
        Role::right_upper_leg, Role::right_lower_leg, Role::right_foot}) {
    if (role == Role::head ? !head : map.joint(role) < 0) missing.push_back(role);
  }
  return missing;
}

}  // namespace krok
