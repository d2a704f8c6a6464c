#include "tools/shared/shared_options.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "terrain/spec.h"

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

}  // namespace krok::cli
