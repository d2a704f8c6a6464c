#include "describe_skeleton.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "formats/role_map/role_map.h"

namespace krok::info {

namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

std::vector<int> depths_of(const Skeleton& skeleton) {
  std::vector<int> depths;
  for (const int parent : skeleton.parents) {
    depths.push_back(parent < 0 ? 0 : depths[at(parent)] + 1);
  }
  return depths;
}

// "upper_arm" in a row of the left arm.
std::string short_name(Role role) {
  std::string name(role_name(role));
  for (const char* side : {"left_", "right_"}) {
    if (name.starts_with(side)) name.erase(0, std::string_view(side).size());
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string joints_of(const Skeleton& skeleton, const std::vector<int>& joints) {
  constexpr std::size_t kMost = 6;
  std::string text;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (i == kMost) return text + fmt::format(" and {} more", joints.size() - kMost);
    text += (i == 0 ? "" : " ") + skeleton.names[at(joints[i])];
  }
  return text;
}

// "hips Hip, spine LowerSpine MiddleSpine, chest Chest", nothing for none.
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

// "thumb 3, index 3": how many joints each finger has; joints of no known finger as "others".
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

void add_row(const std::string& label, std::string text, Description& out) {
  if (!text.empty()) out.add(label, std::move(text));
}

void add_parts(const Skeleton& skeleton, const RoleMap& map, Description& out) {
  const auto row = [&](std::initializer_list<Role> roles) { return row_of(skeleton, map, roles); };
  add_row("trunk", row({Role::root, Role::hips, Role::spine, Role::chest, Role::neck, Role::head}),
          out);
  add_row("left arm",
          row({Role::left_collar, Role::left_upper_arm, Role::left_lower_arm, Role::left_hand}),
          out);
  add_row("left fingers", fingers_of(map, Role::left_fingers), out);
  add_row("right arm",
          row({Role::right_collar, Role::right_upper_arm, Role::right_lower_arm, Role::right_hand}),
          out);
  add_row("right fingers", fingers_of(map, Role::right_fingers), out);
  add_row("left leg",
          row({Role::left_upper_leg, Role::left_lower_leg, Role::left_foot, Role::left_toes}), out);
  add_row("right leg",
          row({Role::right_upper_leg, Role::right_lower_leg, Role::right_foot, Role::right_toes}),
          out);
}

// Each role with its joint, or for roles of many with their joints.
Json roles_json(const Skeleton& skeleton, const RoleMap& map) {
  Json json = Json::object();
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

}  // namespace

Status add_skeleton(const Skeleton& skeleton, const SkeletonOptions& options, Description& out) {
  Result<RoleMap> found = options.map == nullptr
                              ? Result<RoleMap>(find_roles(skeleton))
                              : role_map::read(options.map->text(), options.map->path(), skeleton);
  if (!found) return found.error();
  const RoleMap& map = *found;
  const auto ends = std::count(skeleton.end_sites.begin(), skeleton.end_sites.end(), 1);
  const auto placed = std::count_if(map.roles.begin(), map.roles.end(), [](Role role) {
    return role != Role::none && role != Role::end && role != Role::helper;
  });
  std::string joints = grouped(skeleton.joint_count());
  if (ends > 0) joints += fmt::format(", {} of them end sites", ends);
  out.add("joints", joints);
  out.add("figure", map.humanoid
                        ? fmt::format("humanoid, {} with a role in the body",
                                      count_of(static_cast<std::uint64_t>(placed), "joint"))
                        : std::string("not recognised as a humanoid"));
  add_parts(skeleton, map, out);
  std::string missing;
  Json missing_json = Json::array();
  for (const Role role : missing_roles(map)) {
    missing += (missing.empty() ? "" : ", ") + std::string(role_name(role));
    missing_json.push_back(role_name(role));
  }
  if (!missing.empty()) {
    out.add("missing", placed > 0 ? missing : std::string("every role of a humanoid"));
  }

  out.json["joints"] = skeleton.joint_count();
  out.json["end_sites"] = ends;
  out.json["humanoid"] = map.humanoid;
  out.json["roles"] = roles_json(skeleton, map);
  out.json["missing_roles"] = std::move(missing_json);
  out.json["skeleton"] = Json::array();
  std::vector<std::string> lines;
  const std::vector<int> depths = depths_of(skeleton);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string label = role_label(map, j);
    lines.push_back(fmt::format("{:<23} {:>{}}{}", label == "none" ? "-" : label, "",
                                2 * std::min(depths[at(j)], 40), skeleton.names[at(j)]));
    const int parent = skeleton.parents[at(j)];
    out.json["skeleton"].push_back(
        {{"joint", skeleton.names[at(j)]},
         {"parent", parent < 0 ? Json() : Json(skeleton.names[at(parent)])},
         {"role", label == "none" ? Json() : Json(label)}});
  }
  if (options.verbose) out.add("roles", std::move(lines));
  return {};
}

}  // namespace krok::info
