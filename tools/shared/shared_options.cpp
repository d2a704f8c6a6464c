#include "tools/shared/shared_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/text.h"
#include "roles/roles.h"
#include "skin/twist_joints.h"
#include "terrain/spec.h"
#include "tools/cli/usage.h"

namespace krok::cli {

namespace {

ValueKind<std::string> ground_text() {
  const auto read = [](const std::string& text) -> Result<std::string> {
    std::error_code ignored;
    if (!terrain::is_spec(text) || std::filesystem::exists(text, ignored)) return text;
    const auto made = terrain::from_spec(text);
    if (!made) return made.error();
    return text;
  };
  return {"ground", "IN", read, {}};
}

}  // namespace

ValueKind<Unit> length_unit() {
  return {"unit",
          "UNIT",
          [](const std::string& text) -> Result<Unit> {
            auto unit = parse_unit(text);
            if (!unit) return usage(unit.error().message, unit.error().hint);
            return unit;
          },
          {}};
}

ValueKind<std::string> contacts_file(const std::string& forms) {
  return {
      "contacts", forms, [](const std::string& text) -> Result<std::string> { return text; }, {}};
}

CommandOption add_orientation_option(CommandOptions& command, OrientationEncoding& encoding) {
  return command
      .add("--orientation HOW", encoding,
           choice<OrientationEncoding>(
               {{"xyz", OrientationEncoding::xyz}, {"xyzw", OrientationEncoding::xyzw}}),
           "Quaternion storage: three components (xyz) or all four, exact (xyzw)", "xyz")
      .group("Output");
}

CommandOption add_map_option(CommandOptions& command, std::string& path) {
  return command.add_option("--map IN.json", path,
                            "Role map (JSON) for joints whose names do not identify them");
}

CommandOption add_contacts_option(CommandOptions& command, std::string& contacts) {
  contacts = "auto";
  return command
      .add("--contacts", contacts, contacts_file("IN.json|auto|find"),
           "When the feet stand: a file, find, or auto, which uses NAME.keys.json next to the "
           "motion if it exists")
      .default_str(contacts);
}

CommandOption add_keys_option(CommandOptions& command, KeysChoice& which) {
  return command.add(
      "--contacts WHICH", which,
      contacts_choice<KeysChoice>({{"auto", KeysChoice::automatic},
                                   {"sidecar", KeysChoice::sidecar},
                                   {"none", KeysChoice::none}}),
      "Keytimes: auto (from NAME.keys.json beside a motion, otherwise detected as by krok-keys), "
      "sidecar (only from that file), none (start and end only)",
      "auto");
}

CommandOption add_ground_option(CommandOptions& command, GroundChoice& ground,
                                const std::string& help, const std::string& preset) {
  const CommandOption option = command.add("--ground IN", ground.text, ground_text(), help, preset);
  command.add("--ground-size WIDTHxDEPTH", ground.placement.size,
              lengths<std::array<double, 2>>('x'),
              "Size of a height field along X and Z; otherwise from its sidecar "
              "NAME.ground.json (formats/height_field/SPEC.md)");
  command.add("--ground-range LOW,HIGH", ground.placement.range, lengths<std::array<double, 2>>(),
              "Heights of black and white of a height field, or of 0 and 1: 0,1.5m");
  return option;
}

CommandOption add_prints_option(CommandOptions& command, std::string& path,
                                const std::string& help) {
  return command.add_option("--prints IN", path, help);
}

CommandOption add_body_option(CommandOptions& command, BodyChoice& body, const std::string& help) {
  return command.add("--body DETAIL", body,
                     choice<BodyChoice>({{"auto", BodyChoice::automatic},
                                         {"none", BodyChoice::none},
                                         {"low", BodyChoice::low},
                                         {"medium", BodyChoice::medium},
                                         {"high", BodyChoice::high}}),
                     help, "auto");
}

CommandOption add_skin_method(CommandOptions& command, SkinMethod& method,
                              const std::string& help) {
  return command.add("--method METHOD", method,
                     choice<SkinMethod>({{"linear", SkinMethod::linear},
                                         {"dual-quaternion", SkinMethod::dual_quaternion},
                                         {"spherical", SkinMethod::spherical},
                                         {"rigid", SkinMethod::rigid}}),
                     help, "linear");
}

CommandOption add_clip_option(CommandOptions& command, std::string& clip,
                              const std::string& otherwise) {
  return command.add_option(
      "--clip NAME", clip,
      fmt::format("Animation of a glTF file that has several: name or number from 0 [{}]",
                  otherwise));
}

CommandOption add_plant_flag(CommandOptions& command, bool& plant) {
  return command.add_flag("--plant", plant,
                          "Foot skate clean-up: heel and ball of a foot stay in place while they "
                          "stand, and the legs follow");
}

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
