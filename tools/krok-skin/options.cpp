#include "tools/krok-skin/options.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "formats/io/formats.h"

namespace krok::cli::skin {

namespace {

// The frame nearest to a time given on the command line.
Result<int> frame_at(const char* option, const std::optional<ClipTime>& time, double rate,
                     int frames, int fallback) {
  if (!time) return fallback;
  const double frame = std::round(time->in_frames ? time->value : time->value * rate);
  if (!(frame >= 0 && frame < frames)) {
    return Error("skin-time",
                 fmt::format("{} {} is outside the motion, which has frames 0 to {} ({} s)", option,
                             written(*time), frames - 1, readable((frames - 1) / rate, 4)),
                 frame_hint(*time, frames));
  }
  return static_cast<int>(frame);
}

void declare_what(CommandOptions& command, Options& o) {
  command.add("--as WHAT", o.as,
              choice<As>({{"rig", As::rig},
                          {"motion", As::motion},
                          {"baked", As::baked},
                          {"pose", As::pose},
                          {"frames", As::frames}}),
              "What to write. rig: mesh, joints, weights and animations, for game engines, Blender "
              "and viewers. motion: the same without the mesh. baked: the motion as glTF with one "
              "morph target per frame, or as a point cache (.pc2); large. pose: one mesh. frames: "
              "one file per frame, OUT_0000.glb, OUT_0001.glb, ... for -o OUT.glb. Poses can be "
              ".glb, .gltf or .obj",
              "rig, baked for .pc2");
  command
      .add("--time T", o.time, clip_time(), "For --as pose: the time, such as 1.5s, 250ms or 120f",
           "0")
      .only_with("--as pose");
  command
      .add("--from T", o.from, clip_time(),
           "Start of the range to write, as for --time; not for pose")
      .not_with("--as pose");
  command.add("--to T", o.to, clip_time(), "End of the range, inclusive").not_with("--as pose");
  command.add("--every", o.every, whole(1, 1000000), "Use only every Nth frame", "1")
      .not_with("--as pose");
}

void declare_mesh(CommandOptions& command, Options& o) {
  add_skin_method(
      command, o.method,
      "Skinning method. linear: linear blend skinning, as in viewers; loses volume at "
      "twisted joints. dual-quaternion: preserves volume. spherical: the same about the joint "
      "between two bones, without its bulge. rigid: each vertex follows "
      "only its strongest joint");
  command
      .add_option("--morph IN.exr", o.morphs,
                  "Morph targets (OpenEXR, from krok-morph or krok-import), applied before "
                  "skinning; a character has its own")
      .not_with("--as motion");
  command
      .add_option("--weights IN", o.weights,
                  "Morph target weights over time: a table (CSV) or keys (JSON); from the start of "
                  "the motion. {clip} in the name is the motion's path without its ending, for "
                  "motions with a file each: '{clip}.csv'. Default: those of the motion's own file")
      .not_with("--as motion");
  command
      .add_option("--correctives IN.correctives", o.correctives,
                  "Shapes by pose (from krok-fit), added before skinning: morph targets whose "
                  "weights follow the rotations of joints")
      .not_with("--as motion");
  add_twist_joints_option(command, o.twist);
  command
      .add_option("--attach PLACE=IN", o.attached,
                  "For --as rig: attach the mesh of a file (.glb, .gltf, .model, .obj in metres "
                  "and others) to a socket of the character, or to a joint by name or role: "
                  "right_hand=cup.glb. It "
                  "becomes a node below the joint; the file's origin and axes are the socket's, or "
                  "the joint's; repeatable")
      .one_each_time();
  command.add("--up AXIS", o.up, up_axis<pc2::Up>({{"y", pc2::Up::y}, {"z", pc2::Up::z}}),
              "Up axis of a point cache: y as in the written OBJ and glTF files, or z as in "
              "Blender and 3ds Max",
              "y");
  command.add(
      "--influences N", o.influences,
      choice<Influences>(
          {{"all", Influences::all}, {"4", Influences::four}, {"8", Influences::eight}}),
      "Keep the N largest influences of each vertex, normalised; the error over the motion is "
      "measured on the mesh. More than 4 need a second set of joints and weights in glTF, which "
      "some viewers do not read",
      "all");
  command.add("--reduce TOLERANCE", o.reduce, length_with_unit(kPositive),
              "For --as rig: remove keys while no vertex moves by more than a tolerance, such as "
              "0.1mm, at any frame or half-way between two");
  command.add_flag(
      "--quantize", o.quantize,
      "For --as rig: vertices and, within the tolerance, rotations of 16 bits, normals of 8 "
      "(KHR_mesh_quantization); with --compress and --reduce of as few bits as the tolerance "
      "allows; the error is measured on the mesh");
  command.add_flag("--compress", o.compress,
                   "For --as rig as .glb: compress meshes and keys (EXT_meshopt_compression), "
                   "without --quantize exactly; equal vertices become one, and are reordered");
  command.add_flag("--minify", o.minify,
                   "For --as rig: leave out texture coordinates that no texture uses, where the "
                   "file comes from, and with --reduce keys of joints that all clips hold alike, "
                   "which then rest so without a clip, too");
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option(
          "subject IN.model", o.subject,
          "Skinned mesh: a .model, a .character with its materials and expressions, or what "
          "krok-import makes one of (.glb, .fbx and others)")
      .required();
  command.add_option("motions IN.anim", o.motions,
                     "Motions: .anim, or captures read as by krok-import; several of one skeleton "
                     "become the clips of one rig, named after their files, or walk=IN.anim to "
                     "call one walk. Without any, the mesh is in its reference pose");
  command.add_flag("--retarget", o.retarget,
                   "Move the motions to the mesh's skeleton first, as krok-retarget does without "
                   "further options");
  declare_what(command, o);
  declare_mesh(command, o);
}

bool is_character(const std::string& path) {
  return extension(path) == ".character";
}

Status check(const Options& options) {
  if (options.has_weights_by_clip() && options.motions.empty()) {
    return usage("{clip} in the name of --weights needs a motion");
  }
  if (options.retarget && options.motions.empty()) {
    return usage("--retarget needs a mesh and motions",
                 "the mesh comes first: krok-skin hero.glb takes --retarget -o hero_clips.glb");
  }
  if (!options.weights.empty() && options.morphs.empty() &&
      extension(options.subject) == ".model") {
    return usage("--weights needs morph targets", "add --morph IN.exr; a .character has its own");
  }
  if (!options.morphs.empty() && is_character(options.subject)) {
    return usage("--morph is for a model; a character has its own targets",
                 "edit \"morphs\" in the .character file");
  }
  // Without --as, the output determines it.
  return options.as == As::automatic ? Status() : check_for(options.as, options);
}

}  // namespace

As what_to_write(const Options& options, const std::string& output) {
  if (options.as != As::automatic) return options.as;
  const std::string end = extension(output);
  if (end == ".obj" && options.motions.empty()) return As::pose;
  return end == ".pc2" ? As::baked : As::rig;
}

Status check_for(As as, const Options& options) {
  const bool rigged = as == As::rig || as == As::motion;
  if (!options.morphs.empty() && options.weights.empty() && as != As::rig) {
    return usage("--morph has no effect without --weights",
                 "only --as rig writes targets without weights");
  }
  if (rigged && options.method != SkinMethod::linear) {
    return usage("--method is not for a rig, which leaves skinning to the viewer",
                 "use --as baked to bake the mesh with this method");
  }
  if (as == As::motion && options.motions.empty()) return usage("--as motion needs a motion");
  if (as != As::rig && (options.reduce || options.quantize || options.compress || options.minify)) {
    return usage("--reduce, --quantize, --compress and --minify are for --as rig");
  }
  if (as != As::rig && !options.attached.empty()) return usage("--attach is for --as rig");
  if (options.motions.size() < 2) return {};
  if (!rigged) {
    return usage("several motions are for --as rig and --as motion",
                 "use --out-dir DIR for a file each");
  }
  if (options.from || options.to) {
    return usage("--from and --to are for a single motion", "cut the motions with krok-edit");
  }
  if (!options.weights.empty() && !options.has_weights_by_clip()) {
    return usage("--weights of several motions need {clip} in their name",
                 "--weights '{clip}.csv' has those of walk.anim in walk.csv beside it");
  }
  return {};
}

Result<std::optional<Range>> chosen_range(const Options& options, double rate, int frames) {
  if (!options.from && !options.to && options.every == 1) return std::optional<Range>();
  if (frames == 0) {
    return Error("skin-no-frames", "the motion has no frames for --from, --to, --every");
  }
  const auto first = frame_at("--from", options.from, rate, frames, 0);
  if (!first) return first.error();
  const auto last = frame_at("--to", options.to, rate, frames, frames - 1);
  if (!last) return last.error();
  if (*last < *first) return Error("skin-time", "--from is after --to");
  return std::optional<Range>(Range{*first, *last, options.every});
}

Result<double> pose_time(const Options& options, const Clip& clip) {
  if (!options.time) return 0.0;
  const double seconds = options.time->seconds(clip.rate);
  if (seconds > clip.duration() * (1 + 1e-9)) {
    return Error("skin-time",
                 fmt::format("--time {} is outside the motion, which is {} s long",
                             written(*options.time), readable(clip.duration(), 4)),
                 frame_hint(*options.time, clip.frame_count()))
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
  spec.keeps_going = true;
  spec.folder_endings = io::motion_endings();
  spec.examples = {
      {"krok-skin body.model walk.anim -o walk.glb", "a rig for a game engine or Blender"},
      {"krok-skin hero.character walk.anim run.anim idle.anim -o hero.glb",
       "one character with three clips: walk, run and idle"},
      {"krok-skin hero.glb takes --retarget -o hero_clips.glb",
       "all captures of a folder on another skeleton, a clip each"},
      {"krok-skin hero.character walk.anim run.anim --as motion -o hero_moves.glb",
       "the clips alone, on the same skeleton"},
      {"krok-skin hero.character walk.anim --weights smile.csv -o hero.glb",
       "a character with its materials, eyes and expressions"},
      {"krok-skin hero.character walk.anim talk.anim --weights '{clip}.csv' -o hero.glb",
       "two clips with expressions of their own, from walk.csv and talk.csv"},
      {"krok-skin body.model walk.anim --correctives body.correctives -o walk.glb",
       "joints that keep their volume, as morph targets with a weight at each frame"},
      {"krok-skin hero.character walk.anim --attach right_grip=cup.glb -o hero.glb",
       "a cup in the hand, at a socket of the character"},
      {"krok-skin body.model walk.anim --as pose --time 1.5s -o pose.glb", "one pose"},
      {"krok-skin body.model walk.anim --as baked -o baked.glb",
       "baked vertex animation, for viewers without skinning"},
      {"krok-skin body.model walk.anim -o walk.pc2", "a point cache for Blender or 3ds Max"}};
  spec.each_animation = [options](const std::string& output) {
    const Options& o = *options;
    const As as = o.as == As::automatic && extension(output) == ".pc2" ? As::baked : o.as;
    const bool of_each = o.weights.empty() || o.has_weights_by_clip();
    return (as == As::automatic || as == As::rig || as == As::motion) && !o.from && !o.to &&
           of_each;
  };
  spec.batch = {io::motion_endings(), always(".glb")};
  return spec;
}

}  // namespace krok::cli::skin
