#include "tools/krok-morph/options.h"

#include <fmt/format.h>

#include <memory>

#include "tools/shared/shared_options.h"

namespace krok::cli::morph {

namespace {

constexpr const char *kPack = "action pack", *kUnpack = "action unpack", *kBake = "action bake",
                     *kFrames = "action frames";

struct ActionFacts {
  const char* name;
  Result<int> (*run)(const Options& options, ToolContext& context);
  std::size_t least, most;  // number of files
  const char* files;
  std::vector<std::pair<const char*, const char*>> needs;  // options, and hints
};

// [Action]
const std::vector<ActionFacts> kActions = {
    {"pack", pack, 1, 100'000, "BASE TARGET...", {{"--output", "such as -o face.exr"}}},
    {"unpack", unpack, 2, 2, "TARGETS.exr BASE", {{"--out-dir", "the folder for the shapes"}}},
    {"info", info, 1, 2, "TARGETS.exr [BASE]", {}},
    {"bake",
     bake,
     2,
     2,
     "TARGETS.exr BASE",
     {{"--weights", "the target weights over time"}, {"--output", "such as -o face.glb"}}},
    {"frames", frames, 1, 1, "KEYS.json or FOLDER", {{"--output", "such as -o flag.glb"}}},
};

const ActionFacts& facts_of(Action action) {
  return kActions[static_cast<std::size_t>(action)];
}

void declare_shapes(CommandOptions& command, Options& o) {
  command.group("Shapes");
  command.add("--unit", o.unit, length_unit(),
              "Length unit of OBJ files: m, cm, mm, in, ft or a length such as 5.64cm", "m");
  command.add("--up AXIS", o.up, up_axis<Up>({{"y", Up::y}, {"z", Up::z}}),
              "Up axis of OBJ files: y (character faces +Z) or z (character faces -Y)", "y");
  command
      .add("--match HOW", o.by_order, choice<bool>({{"triangles", false}, {"order", true}}),
           "Match vertices by order; with triangles, shapes must also have those of the first",
           "triangles")
      .only_with({kPack, kFrames});
  command
      .add_option("--name NAME", o.names,
                  "pack: name of a target, once per TARGET in order; default: its file name "
                  "without extension")
      .allow_extra_args(false)
      .only_with(kPack);
}

void declare_unpack(CommandOptions& command, Options& o) {
  command.group("Unpack");
  command.only_with({kUnpack});
  command.add_option("--out-dir DIR", o.out_dir, "unpack: folder for the shapes, one file each");
  command.add("--format FORMAT", o.format,
              choice<ShapeFormat>({{"base", ShapeFormat::as_base},
                                   {"obj", ShapeFormat::obj},
                                   {"glb", ShapeFormat::glb},
                                   {"model", ShapeFormat::model}}),
              "unpack: file format: obj, glb, model, or base: as BASE", "base");
  command
      .add_option("--target NAME", o.targets,
                  "unpack: only the target with this name; may be repeated")
      .allow_extra_args(false);
}

void declare_motion(CommandOptions& command, Options& o) {
  command.group("Motion");
  command
      .add_option("--weights IN.csv|IN.json", o.weights,
                  "bake: target weights over time: a table as written by krok-import "
                  "--morph-weights, or keys (formats/weights/SPEC.md)")
      .only_with(kBake);
  command.only_with({kBake, kFrames});
  command.add("--as WHAT", o.as, choice<As>({{"clip", As::clip}, {"targets", As::targets}}),
              "For glTF. clip: baked, one shape per frame. targets: the shapes and keys for their "
              "weights",
              "clip");
  command.add("--rate", o.rate, rate(),
              "Frames per second; default: from the weights or keys, or else 30");
  command.only_with({kFrames});
  command.add("--between HOW", o.between,
              choice<Between>({{"linear", Between::linear}, {"hermite", Between::hermite}}),
              "frames: interpolation: linear or hermite (cubic); default: from the keys, or else "
              "linear");
  command
      .add("--tension", o.tension, number({0, 1}),
           "frames, hermite: 0 passes smoothly through the keys, 1 stops at each; default: from "
           "the keys, or else 0")
      .not_with("--between linear");
  command.add("--spacing T", o.spacing, clip_time(kPositive),
              "frames of a folder: time between shapes, such as 0.5s, 250ms or 1f", "1f");
  command.add("--save-weights OUT.csv", o.save_weights, output({".csv"}),
              "frames: weight of each key's shape in each frame, as a table for bake and krok-skin "
              "with an .exr of the keys");
}

void declare(CommandOptions& command, Options& o) {
  command
      .add("action ACTION", o.action,
           choice<Action>({{"pack", Action::pack},
                           {"unpack", Action::unpack},
                           {"info", Action::info},
                           {"bake", Action::bake},
                           {"frames", Action::frames}}),
           "pack: write shapes to an .exr of morph targets. unpack: write one file per shape. "
           "info: describe an .exr, and with BASE how far each target moves it. bake: animate "
           "targets over time. frames: interpolate shapes at given times (key-frame mesh)")
      .required();
  command.add_option("files IN", o.files,
                     "Files of the action. BASE and TARGETs: .obj, .glb, .gltf or .model, with the "
                     "same vertices; pack also takes the targets in a glTF BASE");
  declare_shapes(command, o);
  declare_unpack(command, o);
  declare_motion(command, o);
  o.given = [&command](const char* option) { return command.count(option) > 0; };
}

// What the files and -o have to be for the action.
Status check(const Options& o) {
  const ActionFacts& facts = facts_of(o.action);
  if (o.given("--output") && (o.action == Action::unpack || o.action == Action::info)) {
    return usage("-o is for pack, bake or frames",
                 o.action == Action::unpack ? "use --out-dir for the folder of the shapes" : "");
  }
  const std::size_t count = o.files.size();
  if (count < facts.least || count > facts.most) {
    return usage(
        fmt::format("{} takes {}, but {} given", facts.name, facts.files, counted(count, "file")));
  }
  for (const auto& [option, hint] : facts.needs) {
    if (o.given(option)) continue;
    if (option == std::string("--output")) return no_output(hint);
    return usage(fmt::format("{} needs {}", facts.name, option), hint);
  }
  if (o.action != Action::pack || o.names.empty() || o.names.size() == count - 1) return {};
  return usage(fmt::format("{} for {}", counted(o.names.size(), "--name"),
                           counted(count - 1, "target file")),
               "give one for each target, in order");
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  Options ordered = options;
  std::vector<std::string>& files = ordered.files;
  // Of targets and their base, the .exr is the targets.
  if (options.action != Action::pack && files.size() == 2 && extension(files[1]) == ".exr" &&
      extension(files[0]) != ".exr") {
    std::swap(files[0], files[1]);
  }
  return facts_of(options.action).run(ordered, context);
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
