#include "tools/shared/twist_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/text.h"
#include "roles/roles.h"
#include "skin/twist_joints.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"

namespace krok::cli {

namespace {

struct BoneKind {
  std::string_view name;
  std::array<Role, 2> roles;
  bool of_start;
};
constexpr BoneKind kBones[] = {{"upper_arm", {Role::left_upper_arm, Role::right_upper_arm}, true},
                               {"forearm", {Role::left_lower_arm, Role::right_lower_arm}, false},
                               {"thigh", {Role::left_upper_leg, Role::right_upper_leg}, true},
                               {"shin", {Role::left_lower_leg, Role::right_lower_leg}, false}};

Result<TwistJoints> parse(const std::string& text) {
  TwistJoints twist;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string entry = text.substr(begin, end - begin);
    const std::size_t equals = entry.find('=');
    TwistJoints::Bones bones{entry.substr(0, equals), 1};
    const auto named = [&](const auto& of) { return of.name == bones.name; };
    if (std::ranges::none_of(kBones, named) || std::ranges::any_of(twist.bones, named)) {
      return usage(fmt::format("'{}' is not a new one of upper_arm, forearm, thigh and shin",
                               shown(bones.name)),
                   "such as forearm,upper_arm=2");
    }
    if (equals != std::string::npos) {
      const auto count = whole(1, 8).read(entry.substr(equals + 1));
      if (!count) return count.error();
      bones.count = static_cast<int>(*count);
    }
    twist.bones.push_back(std::move(bones));
    begin = end + 1;
  }
  return twist;
}

}  // namespace

void add_twist_joints_option(CommandOptions& command, TwistJoints& twist) {
  command.add(
      "--twist-joints LIST", twist, ValueKind<TwistJoints>{"list", "LIST", parse, {}},
      "Add joints along bones that share out their twist, against the candy wrapper effect: "
      "of upper_arm, forearm, thigh and shin, each with a number of joints (1 to 8, or 1), "
      "such as forearm,upper_arm=2; motions get their rotations");
}

Status add_twist_joints(const TwistJoints& twist, Model& model) {
  const RoleMap roles = find_roles(model.skeleton);
  std::vector<TwistBone> bones;
  for (const TwistJoints::Bones& wanted : twist.bones) {
    const auto* kind = std::ranges::find(kBones, wanted.name, &BoneKind::name);
    const std::size_t before = bones.size();
    for (const Role role : kind->roles) {
      const int joint = roles.joint(role);
      if (joint >= 0) bones.push_back({joint, wanted.count, kind->of_start});
    }
    if (bones.size() > before) continue;
    return Error("twist-joints", fmt::format("no joint of the model is a {}", wanted.name),
                 "joints are found by their names; krok-info shows which were");
  }
  return krok::add_twist_joints(model, bones);
}

}  // namespace krok::cli
