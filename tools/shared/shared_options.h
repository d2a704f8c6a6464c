#pragma once

#include <memory>
#include <string>
#include <vector>

#include "body/body.h"
#include "capture/conventions.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "formats/io/open_terrain.h"
#include "scene/model.h"
#include "skin/skin.h"
#include "tools/cli/command_options.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/tool.h"
#include "tools/shared/keys_sidecar.h"

// Options that several tools have, each declared here alone. `help` is what differs between tools.

namespace krok::cli {

// A ground that the user names, for io::open_terrain().
struct GroundChoice {
  std::string text;  // empty for none
  height_field::Placement placement;

  bool empty() const { return text.empty(); }
  // Null if it is empty.
  Result<std::unique_ptr<Terrain>> open(io::Inputs& inputs) const {
    if (empty()) return std::unique_ptr<Terrain>();
    return io::open_terrain(text, placement, inputs);
  }
};

// --body, for tools that show motions: the generated body for a motion without one. The meaning of
// automatic depends on the tool.
enum class BodyChoice : unsigned char { automatic, none, low, medium, high };

// Options for generating the body; `choice` is low, medium or high.
inline BodyOptions body_options(BodyChoice choice, const ToolContext& context) {
  BodyOptions how;
  how.detail = choice == BodyChoice::low      ? BodyDetail::low
               : choice == BodyChoice::medium ? BodyDetail::medium
                                              : BodyDetail::high;
  how.jobs = context.jobs;
  how.progress = context.progress;
  return how;
}

// How values between keys are made: on straight lines, or on cubics (positions by Hermite's,
// rotations by squad) whose velocities at the keys are 1 - tension of those between the neighbours.
struct Interpolation {
  bool hermite = false;
  double tension = 0;  // 0 to 1
};

// linear, hermite or hermite:0.5.
inline ValueKind<Interpolation> interpolation() {
  return {"interpolation",
          "linear|hermite[:TENSION]",
          [](const std::string& text) -> Result<Interpolation> {
            if (text == "linear") return Interpolation{};
            if (text == "hermite") return Interpolation{.hermite = true};
            if (text.starts_with("hermite:")) {
              const auto tension = number({0, 1}).read(text.substr(8));
              if (!tension) return tension.error();
              return Interpolation{.hermite = true, .tension = *tension};
            }
            return usage("'" + text + "' is neither linear nor hermite",
                         "write linear, hermite, or hermite:0.5 with a tension from 0 (smooth) to "
                         "1 (stops at each key)");
          },
          {"linear", "hermite"}};
}

// A unit of length of a file: m, cm, ..., or a length.
ValueKind<Unit> length_unit();

// --orientation, for tools that write one of Krok's binary formats; in the group Output.
CommandOption add_orientation_option(CommandOptions& command, OrientationEncoding& encoding);

// --map: a role map for joints whose names do not identify them.
CommandOption add_map_option(CommandOptions& command, std::string& path);

// Values of --contacts: a file, or one of the words of `forms`, such as "IN.json|auto|none".
ValueKind<std::string> contacts_file(const std::string& forms);
// The same for words alone.
template <typename T>
ValueKind<T> contacts_choice(std::vector<std::pair<std::string, T>> words) {
  ValueKind<T> kind = choice(std::move(words));
  kind.name = "contacts";
  return kind;
}

// The up axis of files that have one of two.
template <typename T>
ValueKind<T> up_axis(std::vector<std::pair<std::string, T>> words) {
  ValueKind<T> kind = choice(std::move(words));
  kind.name = "axis";
  return kind;
}

// --contacts: when the feet stand. A file, "find", or "auto": the sidecar beside the motion if
// there is one.
CommandOption add_contacts_option(CommandOptions& command, std::string& contacts);

// --contacts, for a tool that combines motions: where it gets their contacts and keytimes.
CommandOption add_keys_option(CommandOptions& command, KeysChoice& choice);

// --ground: a file, or a made ground, whose text must be right: codes of terrain::from_spec().
// Whether a file is there and holds a ground shows when it is opened. --ground-size and
// --ground-range place a height field.
CommandOption add_ground_option(CommandOptions& command, GroundChoice& ground,
                                const std::string& help, const std::string& preset = {});

// --prints: footprints.
CommandOption add_prints_option(CommandOptions& command, std::string& path,
                                const std::string& help);

// --body: the generated body for a motion without one.
CommandOption add_body_option(CommandOptions& command, BodyChoice& choice, const std::string& help);

// --method, for tools that move meshes by joints.
CommandOption add_skin_method(CommandOptions& command, SkinMethod& method, const std::string& help);

// The texts of --body and --method where motions are drawn.
inline constexpr const char* kShownBody =
    "Body for motions without a model: low (2,500 vertices), medium (10,000), high (40,000), auto: "
    "low for more than two files, else medium; none: bones only";
inline constexpr const char* kShownMethod =
    "Skinning method: linear, as viewers use it, dual-quaternion, which keeps the volume of "
    "twisted "
    "joints, or rigid; not for glTF files";

// --clip, of glTF files that are shown: a name or an index; `otherwise` says what is shown without.
CommandOption add_clip_option(CommandOptions& command, std::string& clip,
                              const std::string& otherwise =
                                  "the first that moves at least half as many joints as any other");

// --plant, of the tools that blend.
CommandOption add_plant_flag(CommandOptions& command, bool& plant);

// The kinds of bones of --twist-joints, and how many joints each gets.
struct TwistJoints {
  struct Bones {
    std::string name;  // upper_arm, forearm, thigh or shin
    int count = 1;
  };
  std::vector<Bones> bones;  // each once; none: no twist joints
};

// --twist-joints LIST.
void add_twist_joints_option(CommandOptions& command, TwistJoints& twist);

// Adds them to both sides of a model whose joints' roles are found by their names. An Error (code
// twist-joints) for a bone that neither side has, and those of krok::add_twist_joints().
Status add_twist_joints(const TwistJoints& twist, Model& model);

}  // namespace krok::cli
