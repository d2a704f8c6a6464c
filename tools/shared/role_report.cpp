#include "tools/shared/role_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "core/index.h"
#include "core/numbers.h"

namespace krok::cli {

namespace {

// Whether a joint with this role is part of the body.
bool is_of_body(Role role) {
  return role != Role::none && role != Role::end && role != Role::helper;
}

// "upper_arm" in the row of the left arm.
std::string short_name(Role role) {
  std::string name(role_name(role));
  for (const char* side : {"left_", "right_"}) {
    if (name.starts_with(side)) name.erase(0, std::string_view(side).size());
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// "Neck Head"; long lists end in "... and 7 more".
std::string joints_of(const Skeleton& skeleton, const std::vector<int>& joints) {
  constexpr std::size_t kMax = 6;
  std::string text;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (i == kMax) return text + fmt::format(" and {} more", joints.size() - kMax);
    text += (i == 0 ? "" : " ") + skeleton.names[at(joints[i])];
  }
  return text;
}

// "hips Hip, spine LowerSpine MiddleSpine, chest Chest"; empty for none.
std::string row_of(const Skeleton& skeleton, const RoleMap& map,
                   std::initializer_list<Role> roles) {
  std::string text;
  for (const Role role : roles) {
    const std::vector<int> joints = map.joints(role);
    if (joints.empty()) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", short_name(role),
                        joints_of(skeleton, joints));
  }
  return text;
}

// "thumb 3, index 3": joints per finger; joints of unknown fingers are "others".
std::string fingers_of(const RoleMap& map, Role fingers) {
  std::string text;
  const std::vector<int> joints = map.joints(fingers);
  const auto add = [&](Finger finger, const std::string& name) {
    const auto count = std::count_if(joints.begin(), joints.end(), [&](int joint) {
      return map.fingers[at(joint)].finger == finger;
    });
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
  };
  add(Finger::thumb, "thumb");
  add(Finger::index, "index");
  add(Finger::middle, "middle");
  add(Finger::ring, "ring");
  add(Finger::little, "little");
  add(Finger::all, "all in one");
  add(Finger::none, "others");
  return text.empty() ? text : text + " joints";
}

void add_parts(const Skeleton& skeleton, const RoleMap& map, std::vector<RoleRow>& rows) {
  const auto add = [&](const char* label, std::string text) {
    if (!text.empty()) rows.push_back({label, std::move(text)});
  };
  const auto row = [&](std::initializer_list<Role> roles) { return row_of(skeleton, map, roles); };
  add("trunk", row({Role::root, Role::hips, Role::spine, Role::chest, Role::neck, Role::head}));
  add("left arm",
      row({Role::left_collar, Role::left_upper_arm, Role::left_lower_arm, Role::left_hand}));
  add("left fingers", fingers_of(map, Role::left_fingers));
  add("right arm",
      row({Role::right_collar, Role::right_upper_arm, Role::right_lower_arm, Role::right_hand}));
  add("right fingers", fingers_of(map, Role::right_fingers));
  add("left leg",
      row({Role::left_upper_leg, Role::left_lower_leg, Role::left_foot, Role::left_toes}));
  add("right leg",
      row({Role::right_upper_leg, Role::right_lower_leg, Role::right_foot, Role::right_toes}));
}

// Maps each role to its joint, or to a list for roles that several joints may have.
Json joints_by_role(const Skeleton& skeleton, const RoleMap& map) {
  Json json = object_for(map.roles.size());
  for (std::size_t j = 0; j < map.roles.size(); ++j) {
    const Role role = map.roles[j];
    if (role == Role::none || role == Role::end) continue;
    Json& entry = json[role_label(map, static_cast<int>(j))];
    const bool one = !is_role_of_many(role) || map.fingers[j].finger != Finger::none;
    if (one && entry.is_null()) {
      entry = skeleton.names[j];
    } else {
      if (!entry.is_array()) entry = entry.is_null() ? Json::array() : Json::array({entry});
      entry.push_back(skeleton.names[j]);
    }
  }
  return json;
}

// Joints of unknown role.
std::vector<int> unknown_joints(const RoleMap& map) {
  return map.joints(Role::none);
}

std::vector<int> given_joints(const RoleMap& map) {
  std::vector<int> joints;
  for (std::size_t j = 0; j < map.given.size(); ++j) {
    if (map.given[j] != 0) joints.push_back(static_cast<int>(j));
  }
  return joints;
}

// "Bone_012 left_hand, Bone_013 none".
std::string given_of(const Skeleton& skeleton, const RoleMap& map) {
  constexpr std::size_t kMax = 12;
  const std::vector<int> joints = given_joints(map);
  std::string text;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (i == kMax) return text + fmt::format(" and {} more", joints.size() - kMax);
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", skeleton.names[at(joints[i])],
                        role_label(map, joints[i]));
  }
  return text;
}

std::string actor_of(const RoleMap& map) {
  if (!map.humanoid) return "not recognised as a humanoid";
  const auto placed = std::count_if(map.roles.begin(), map.roles.end(), is_of_body);
  return fmt::format("humanoid, {} with a body role", counted(placed, "joint"));
}

}  // namespace

std::vector<RoleRow> role_rows(const Skeleton& skeleton, const RoleMap& map) {
  std::vector<RoleRow> rows;
  rows.push_back({"body", actor_of(map)});
  add_parts(skeleton, map, rows);
  std::string missing;
  for (const Role role : missing_roles(map)) {
    missing += (missing.empty() ? "" : ", ") + std::string(role_name(role));
  }
  const bool any = std::any_of(map.roles.begin(), map.roles.end(), is_of_body);
  if (!missing.empty()) {
    rows.push_back({"missing", any ? missing : std::string("every role of a humanoid")});
  }
  if (const std::vector<int> unknown = unknown_joints(map); !unknown.empty()) {
    rows.push_back({"no role", fmt::format("{}: {}", counted(std::ssize(unknown), "joint"),
                                           joints_of(skeleton, unknown))});
  }
  if (std::string given = given_of(skeleton, map); !given.empty()) {
    rows.push_back({"as given", std::move(given)});
  }
  return rows;
}

Json roles_json(const Skeleton& skeleton, const RoleMap& map) {
  Json json = object_for(5);
  json["humanoid"] = map.humanoid;
  json["roles"] = joints_by_role(skeleton, map);
  json["missing_roles"] = Json::array();
  for (const Role role : missing_roles(map)) json["missing_roles"].push_back(role_name(role));
  json["unknown_joints"] = Json::array();
  for (const int joint : unknown_joints(map)) {
    json["unknown_joints"].push_back(skeleton.names[at(joint)]);
  }
  json["given_roles"] = Json::object();
  for (const int joint : given_joints(map)) {
    const bool none = map.roles[at(joint)] == Role::none;
    json["given_roles"][skeleton.names[at(joint)]] = none ? Json() : Json(role_label(map, joint));
  }
  return json;
}

Json stature_json(const std::optional<Stature>& stature) {
  if (!stature) return {};
  return {{"metres", stature->metres}, {"uncertainty", stature->uncertainty}};
}

}  // namespace krok::cli
