#include "tools/krok-morph/options.h"

#include <fmt/format.h>

#include <array>
#include <memory>

#include "capture/conventions.h"
#include "core/numbers.h"
#include "core/quantity.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"
#include "tools/krok-morph/run.h"

namespace krok::cli::morph {

namespace {

constexpr unsigned bit(Action action) {
  return 1u << static_cast<unsigned>(action);
}
constexpr unsigned kPack = bit(Action::pack), kUnpack = bit(Action::unpack),
                   kInfo = bit(Action::info), kBake = bit(Action::bake),
                   kFrames = bit(Action::frames);

struct ActionFacts {
  Action action;
  const char* name;
  std::size_t least, most;  // number of files
  const char* files;
};
constexpr std::array kActions = {
    ActionFacts{Action::pack, "pack", 1, 100'000, "BASE TARGET..."},
    ActionFacts{Action::unpack, "unpack", 2, 2, "TARGETS.exr BASE"},
    ActionFacts{Action::info, "info", 1, 2, "TARGETS.exr [BASE]"},
    ActionFacts{Action::bake, "bake", 2, 2, "TARGETS.exr BASE"},
    ActionFacts{Action::frames, "frames", 1, 1, "KEYS.json or FOLDER"},
};

// The actions that an option applies to.
struct OptionUse {
  const char* option;
  unsigned actions;
};
constexpr std::array kUses = {
    OptionUse{"--name", kPack},
    OptionUse{"--by-order", kPack | kFrames},
    OptionUse{"--out-dir", kUnpack},
    OptionUse{"--format", kUnpack},
    OptionUse{"--target", kUnpack},
    OptionUse{"--weights", kBake},
    OptionUse{"--as", kBake | kFrames},
    OptionUse{"--rate", kBake | kFrames},
    OptionUse{"--between", kFrames},
    OptionUse{"--tension", kFrames},
    OptionUse{"--spacing", kFrames},
    OptionUse{"--save-weights", kFrames},
    OptionUse{"--output", kPack | kBake | kFrames},
};

const ActionFacts& facts_of(Action action) {
  return kActions[static_cast<std::size_t>(action)];
}

// "pack, bake and frames".
std::string words_for(unsigned actions) {
  std::vector<std::string> names;
  for (const ActionFacts& one : kActions) {
    if ((actions & bit(one.action)) != 0) names.emplace_back(one.name);
  }
  std::string words = names[0];
  for (std::size_t i = 1; i < names.size(); ++i) {
    words += (i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  return words;
}

void declare_shapes(CommandOptions& command, Options& options) {
  command.group("Shapes");
  command
      .add_option_function(
          "--unit UNIT",
          [&options](const std::string& text) {
            const auto unit = parse_unit(text);
            if (unit) options.metres_per_unit = unit->metres;
          },
          "Length unit of OBJ files: m, cm, mm, in, ft or a length such as 5.64cm")
      .default_str("m")
      .check([](std::string& text) {
        const auto unit = parse_unit(text);
        return unit ? std::string() : unit.error().message;
      });
  add_choice<Up>(command, "--up", options.up, {{"y", Up::y}, {"z", Up::z}},
                 "Up axis of OBJ files: y (character faces +Z) or z (character faces -Y)", "AXIS",
                 "y");
  command.add_flag(
      "--by-order", options.by_order,
      "Match vertices by order only; by default shapes must also have the triangles of the first");
  command
      .add_option("--name NAME", options.names,
                  "pack: name of a target, once per TARGET in order; default: its file name "
                  "without extension")
      .allow_extra_args(false);
}

void declare_unpack(CommandOptions& command, Options& options) {
  command.group("Unpack");
  command.add_option("--out-dir DIR", options.out_dir,
                     "unpack: folder for the shapes, one file each");
  add_choice<ShapeFormat>(command, "--format", options.format,
                          {{"base", ShapeFormat::as_base},
                           {"obj", ShapeFormat::obj},
                           {"glb", ShapeFormat::glb},
                           {"model", ShapeFormat::model}},
                          "unpack: file format: obj, glb, model, or base: as BASE", "FORMAT",
                          "base");
  command
      .add_option("--target NAME", options.targets,
                  "unpack: only the target with this name; may be repeated")
      .allow_extra_args(false);
}

void declare_motion(CommandOptions& command, Options& options) {
  command.group("Motion");
  command.add_option("--weights IN.csv|IN.json", options.weights,
                     "bake: target weights over time: a table as written by krok-import "
                     "--morph-weights, or keys (formats/weights/SPEC.md)");
  add_choice<As>(
      command, "--as", options.as, {{"clip", As::clip}, {"targets", As::targets}},
      "For glTF. clip: baked, one shape per frame. targets: the shapes and keys for their weights",
      "WHAT", "clip");
  add_rate(command, "--rate", options.rate,
           "Frames per second; default: from the weights or keys, or else 30");
  add_choice<Between>(
      command, "--between", options.between,
      {{"linear", Between::linear}, {"hermite", Between::hermite}},
      "frames: interpolation: linear or hermite (cubic); default: from the keys, or else linear",
      "HOW", "");
  add_number(command, "--tension", options.tension,
             "frames, hermite: 0 passes smoothly through the keys, 1 stops at each; default: from "
             "the keys, or else 0");
  command
      .add_option("--spacing T", options.spacing,
                  "frames of a folder: time between shapes, such as 0.5s, 250ms or 1f")
      .default_str("1f");
  command.add_option("--save-weights OUT.csv", options.save_weights,
                     "frames: weight of each key's shape in each frame, as a table for bake and "
                     "krok-skin with an .exr of the keys");
}

Status check_uses(const Options& options) {
  for (const OptionUse& use : kUses) {
    if ((use.actions & bit(options.action)) != 0 || !options.given(use.option)) continue;
    const std::string option = std::string_view(use.option) == "--output" ? "-o" : use.option;
    return usage(fmt::format("{} is for {}", option, words_for(use.actions)),
                 options.action == Action::unpack && option == "-o"
                     ? "use --out-dir for the folder of the shapes"
                     : "");
  }
  return {};
}

Status check_files(const Options& options) {
  const ActionFacts& facts = facts_of(options.action);
  const std::size_t count = options.files.size();
  if (count >= facts.least && count <= facts.most) return {};
  return usage(fmt::format("{} takes {}, but {} given", facts.name, facts.files,
                           counted(static_cast<long long>(count), "file")));
}

Status check_needs(const Options& options) {
  const auto needs = [&](const char* option, const char* hint) -> Status {
    if (options.given(option)) return {};
    const std::string shown_option = std::string_view(option) == "--output" ? "-o" : option;
    return usage(fmt::format("{} needs {}", facts_of(options.action).name, shown_option), hint);
  };
  switch (options.action) {
    case Action::pack:
      return needs("--output", "such as -o face.exr");
    case Action::unpack:
      return needs("--out-dir", "the folder for the shapes");
    case Action::bake:
      if (Status status = needs("--weights", "the target weights over time"); !status) {
        return status;
      }
      return needs("--output", "such as -o face.glb");
    case Action::frames:
      return needs("--output", "such as -o flag.glb");
    case Action::info:
      return {};
  }
  return {};
}

}  // namespace

void declare(CommandOptions& command, Options& options) {
  add_choice<Action>(
      command, "action", options.action,
      {{"pack", Action::pack},
       {"unpack", Action::unpack},
       {"info", Action::info},
       {"bake", Action::bake},
       {"frames", Action::frames}},
      "pack: write shapes to an .exr of morph targets. unpack: write one file per shape. info: "
      "describe an .exr, and with BASE how far each target moves it. bake: animate targets over "
      "time. frames: interpolate shapes at given times (key-frame mesh)",
      "ACTION", "")
      .required();
  command
      .add_option("files IN", options.files,
                  "Files of the action. BASE and TARGETs: .obj, .glb, .gltf or .model, with the "
                  "same vertices; pack also takes the targets in a glTF BASE")
      .required();
  declare_shapes(command, options);
  declare_unpack(command, options);
  declare_motion(command, options);
  options.given = [&command](const char* option) { return command.count(option) > 0; };
}

Status check(const Options& options) {
  for (const auto step : {check_uses, check_files, check_needs}) {
    if (Status status = step(options); !status) return status;
  }
  if (options.action == Action::pack && !options.names.empty() &&
      options.names.size() != options.files.size() - 1) {
    return usage(
        fmt::format("{} for {}", counted(static_cast<long long>(options.names.size()), "--name"),
                    counted(static_cast<long long>(options.files.size()) - 1, "target file")),
        "give one for each target, in order");
  }
  if (options.tension && !(*options.tension >= 0 && *options.tension <= 1)) {
    return usage(fmt::format("--tension {} is not between 0 and 1", readable(*options.tension)));
  }
  if (options.tension && options.between == Between::linear) {
    return usage("--tension is for --between hermite");
  }
  if (options.spacing.empty()) return {};
  const auto spacing = parse_clip_time(options.spacing);
  if (!spacing) return usage("--spacing: " + spacing.error().message, spacing.error().hint);
  if (spacing->value > 0) return {};
  return usage("--spacing is not greater than 0");
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-morph", options, declare, check, run);
  spec.summary = "Packs, unpacks and animates morph targets; bakes key-frame meshes";
  spec.details = "Morph targets are packed into a float texture.";
  spec.inputs = "pack|unpack|info|bake|frames IN...";
  spec.examples = {
      {"krok-morph pack face.obj smile.obj blink.obj -o face.exr",
       "two targets, smile and blink, of the mesh in face.obj"},
      {"krok-morph pack hero.glb -o hero.exr", "the targets of a glTF character"},
      {"krok-morph info face.exr face.obj", "lists the targets and how far each moves the mesh"},
      {"krok-morph unpack face.exr face.obj --out-dir shapes", "back to shapes/smile.obj, ..."},
      {"krok-morph bake face.exr face.obj --weights talk.json -o talk.glb",
       "animates the face with hand-written keys"},
      {"krok-morph frames flag.json -o flag.glb", "a key-frame mesh, interpolated between shapes"},
      {"krok-morph frames flag_shapes --spacing 0.5s --between hermite -o flag.pc2",
       "a folder of shapes every 0.5 s, cubic interpolation, as a point cache"}};
  spec.needs_output = false;
  return spec;
}

}  // namespace krok::cli::morph
