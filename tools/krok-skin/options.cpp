#include "tools/krok-skin/options.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "core/numbers.h"
#include "core/quantity.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-skin/run.h"
#include "tools/shared/skin_method_option.h"

namespace krok::cli::skin {

namespace {

Error at_option(const char* option, Error error) {
  error.message = fmt::format("{}: {}", option, error.message);
  return error;
}

// The frame nearest to a time given on the command line.
Result<int> frame_at(const char* option, const std::string& text, const Clip& clip, int fallback) {
  if (text.empty()) return fallback;
  const auto time = parse_clip_time(text);
  if (!time) return at_option(option, time.error());
  const double frame = std::round(time->in_frames ? time->value : time->value * clip.rate);
  if (!(frame >= 0 && frame < clip.frame_count())) {
    return Error("skin-time",
                 fmt::format("{} {} is outside the motion, which has frames 0 to {} ({} s)", option,
                             text, clip.frame_count() - 1, readable(clip.duration())));
  }
  return static_cast<int>(frame);
}

Status check_time(const char* option, const std::string& text) {
  if (text.empty()) return {};
  const auto time = parse_clip_time(text);
  if (!time) return at_option(option, time.error());
  if (time->value >= 0) return {};
  return Error("skin-time", fmt::format("{} {} is less than 0", option, text));
}

}  // namespace

bool is_character(const std::string& path) {
  return extension(path) == ".character";
}

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("subject IN.model", options.subject,
                  "Skinned mesh: a .model, or a .character with its materials and expressions")
      .required();
  command.add_option("motions IN.anim", options.motions,
                     "Motions: .anim, or captures read as by krok-import; several of one skeleton "
                     "become the clips of one rig, named after their files. Without any, the mesh "
                     "is in its reference pose");
  add_choice(command, "--as", options.as,
             {{"rig", As::rig},
              {"motion", As::motion},
              {"baked", As::baked},
              {"pose", As::pose},
              {"frames", As::frames}},
             "What to write. rig: mesh, joints, weights and animations, for game engines, Blender "
             "and viewers. motion: the same without the mesh. baked: the motion as glTF with one "
             "morph target per frame, or as a point cache (.pc2); large. pose: one mesh. frames: "
             "one file per frame, OUT_0000.glb, OUT_0001.glb, ... for -o OUT.glb. Poses can be "
             ".glb, .gltf or .obj",
             "WHAT", "rig, baked for .pc2");
  command
      .add_option("--time T", options.time, "For --as pose: the time, such as 1.5s, 250ms or 120f")
      .default_str("0");
  command.add_option("--from T", options.from,
                     "Start of the range to write, as for --time; not for pose");
  command.add_option("--to T", options.to, "End of the range, inclusive");
  add_whole(command, "--every", options.every, "Use only every Nth frame", 1, 1000000)
      .default_str("1");
  add_skin_method(command, options.method,
                  "Skinning method. linear: linear blend skinning, as in viewers; loses volume at "
                  "twisted joints. dual-quaternion: preserves volume. rigid: each vertex follows "
                  "only its strongest joint");
  command.add_option("--morph IN.exr", options.morphs,
                     "Morph targets (OpenEXR, from krok-morph or krok-import), applied before "
                     "skinning; a character has its own");
  command.add_option(
      "--weights IN", options.weights,
      "Morph target weights over time: a table (CSV) or keys (JSON); from the start of the motion");
  add_choice(command, "--up", options.up, {{"y", pc2::Up::y}, {"z", pc2::Up::z}},
             "Up axis of a point cache: y as in the written OBJ and glTF files, or z as in Blender "
             "and 3ds Max",
             "AXIS", "y");
  add_choice(command, "--influences", options.influences,
             {{"all", Influences::all}, {"4", Influences::four}, {"8", Influences::eight}},
             "Keep the N largest influences of each vertex, normalised; the error over the motion "
             "is measured on the mesh. More than 4 need a second set of joints and weights in "
             "glTF, which some viewers do not read",
             "N", "all");
  command.add_option("--reduce TOLERANCE", options.reduce,
                     "For --as rig: remove keys while no vertex moves by more than a tolerance, "
                     "such as 0.1mm, at any frame or half-way between two");
  command.add_flag(
      "--quantize", options.quantize,
      "For --as rig: vertices and, within the tolerance, rotations of 16 bits, normals of 8 "
      "(KHR_mesh_quantization); with --compress and --reduce of as few bits as the tolerance "
      "allows; the error is measured on the mesh");
  command.add_flag("--compress", options.compress,
                   "For --as rig as .glb: compress meshes and keys (EXT_meshopt_compression), "
                   "without --quantize exactly; equal vertices become one, and are reordered");
}

Result<double> reduce_tolerance(const Options& options) {
  const auto tolerance = parse_length_with_unit(options.reduce);
  if (!tolerance) return at_option("--reduce", tolerance.error());
  if (*tolerance > 0) return *tolerance;
  return Error("usage", fmt::format("--reduce {} is not more than 0", options.reduce));
}

As what_to_write(const Options& options, const std::string& output) {
  if (options.as != As::automatic) return options.as;
  return extension(output) == ".pc2" ? As::baked : As::rig;
}

// Options without effect are errors.
Status check(const Options& options) {
  for (const auto& [option, text] :
       {std::pair{"--time", &options.time}, {"--from", &options.from}, {"--to", &options.to}}) {
    if (Status status = check_time(option, *text); !status) return status;
  }
  if (!options.weights.empty() && options.morphs.empty() && !is_character(options.subject)) {
    return Error("usage", "--weights needs morph targets",
                 "add --morph IN.exr; a .character has its own");
  }
  if (!options.morphs.empty() && is_character(options.subject)) {
    return Error("usage", "--morph is for a model; a character has its own targets",
                 "edit \"morphs\" in the .character file");
  }
  if (options.as != As::pose && !options.time.empty()) {
    return Error("usage", "--time is for --as pose",
                 "use --from and --to for a range of the motion");
  }
  // Without --as, the output determines it.
  return options.as == As::automatic ? Status() : check_for(options.as, options);
}

Status check_for(As as, const Options& options) {
  const bool pose = as == As::pose, rigged = as == As::rig || as == As::motion;
  if (!options.morphs.empty() && options.weights.empty() && as != As::rig) {
    return Error("usage", "--morph has no effect without --weights",
                 "only --as rig writes targets without weights");
  }
  if (rigged && options.method != SkinMethod::linear) {
    return Error("usage", "--method is not for a rig, which leaves skinning to the viewer",
                 "use --as baked to bake the mesh with this method");
  }
  if (as == As::motion && !(options.morphs.empty() && options.weights.empty())) {
    return Error("usage", "--morph and --weights are not for --as motion, which has no mesh",
                 "use --as rig");
  }
  if (as == As::motion && options.motions.empty()) {
    return Error("usage", "--as motion needs a motion");
  }
  if (as != As::rig && (!options.reduce.empty() || options.quantize || options.compress)) {
    return Error("usage", "--reduce, --quantize and --compress are for --as rig");
  }
  if (!options.reduce.empty()) {
    if (const auto tolerance = reduce_tolerance(options); !tolerance) return tolerance.error();
  }
  if (pose && !(options.from.empty() && options.to.empty() && options.every == 1)) {
    return Error("usage", "--from, --to and --every are not for --as pose", "use --time");
  }
  if (options.motions.size() < 2) return {};
  if (!rigged) {
    return Error("usage", "several motions are for --as rig and --as motion",
                 "use --out-dir DIR for a file each");
  }
  if (!(options.from.empty() && options.to.empty() && options.weights.empty())) {
    return Error("usage", "--from, --to and --weights are for a single motion",
                 "cut the motions with krok-edit");
  }
  return {};
}

Result<std::optional<Range>> chosen_range(const Options& options, const Clip& clip) {
  const int frames = clip.frame_count();
  if (options.from.empty() && options.to.empty() && options.every == 1) {
    return std::optional<Range>();
  }
  if (frames == 0) {
    return Error("skin-no-frames", "the motion has no frames for --from, --to, --every");
  }
  const auto first = frame_at("--from", options.from, clip, 0);
  if (!first) return first.error();
  const auto last = frame_at("--to", options.to, clip, frames - 1);
  if (!last) return last.error();
  if (*last < *first) {
    return Error("skin-time", fmt::format("--from {} is after --to {}", options.from, options.to));
  }
  return std::optional<Range>(Range{*first, *last, options.every});
}

Result<double> pose_time(const Options& options, const Clip& clip) {
  if (options.time.empty()) return 0.0;
  const auto time = parse_clip_time(options.time);
  if (!time) return at_option("--time", time.error());
  const double seconds = time->seconds(clip.rate);
  if (seconds < 0 || seconds > clip.duration() * (1 + 1e-9)) {
    return Error("skin-time", fmt::format("--time {} is outside the motion, which is {} s long",
                                          options.time, readable(clip.duration())))
        .in_file(options.motions.empty() ? options.subject : options.motions.front());
  }
  return seconds;
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-skin", options, declare, check, run);
  spec.summary = "Skins a mesh with a motion; writes glTF, a point cache or OBJ files";
  spec.exit_no = "the file is written, but its error is larger than --reduce allows";
  spec.inputs = "IN.model IN.anim...";
  spec.examples = {
      {"krok-skin body.model walk.anim -o walk.glb", "a rig for a game engine or Blender"},
      {"krok-skin hero.character walk.anim run.anim idle.anim -o hero.glb",
       "one character with three clips: walk, run and idle"},
      {"krok-skin hero.character walk.anim run.anim --as motion -o hero_moves.glb",
       "the clips alone, on the same skeleton"},
      {"krok-skin hero.character walk.anim --weights smile.csv -o hero.glb",
       "a character with its materials, eyes and expressions"},
      {"krok-skin body.model walk.anim --as pose --time 1.5s -o pose.glb", "one pose"},
      {"krok-skin body.model walk.anim --as baked -o baked.glb",
       "baked vertex animation, for viewers without skinning"},
      {"krok-skin body.model walk.anim -o walk.pc2", "a point cache for Blender or 3ds Max"}};
  spec.batch = {{".anim", ".kanim"}, always(".glb")};
  return spec;
}

}  // namespace krok::cli::skin
