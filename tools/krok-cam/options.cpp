#include "tools/krok-cam/options.h"

#include <memory>

#include "formats/io/formats.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-cam/run.h"
#include "tools/shared/orientation_option.h"
#include "tools/shared/role_input.h"

namespace krok::cli::cam {

namespace {

void declare_subject(CommandOptions& command, Arguments& a) {
  command.group("Filming a motion");
  command.add_option("--follow JOINT", a.follow,
                     "Follow a joint, given by name or role: hips, chest, head, left_hand");
  command.add_option("--orbit TIME", a.orbit,
                     "Orbit the character: 20s is the time of one turn, 1.5turns is the number of "
                     "turns over the whole motion");
  command.add_flag("--still", a.still, "Static camera that shows the whole motion");
  add_map_option(command, a.map);
}

void declare_place(CommandOptions& command, Arguments& a) {
  command.group("View direction");
  add_choice<View>(command, "--view", a.view,
                   {{"front", View::front},
                    {"three-quarter", View::three_quarter},
                    {"left", View::left},
                    {"right", View::right},
                    {"back", View::back},
                    {"top", View::top}},
                   "front, three-quarter (between the character's front and left), left, right, "
                   "back or top; an orbit starts there",
                   "VIEW", "three-quarter");
  command.add_option("--azimuth ANGLE", a.azimuth,
                     "The same as an angle: 0 sees the character's front, 90deg its left side");
  command.add_option("--elevation ANGLE", a.elevation,
                     "Camera elevation; 90deg looks straight down [10deg]");
  add_choice<AzimuthFrom>(
      command, "--facing", a.facing,
      {{"start", AzimuthFrom::start}, {"actor", AzimuthFrom::actor}, {"world", AzimuthFrom::world}},
      "What counts as the front: the facing at the start, the facing in each "
      "frame (actor), or +Z (world)",
      "WHAT", "start");
  command.add_flag("--clockwise", a.clockwise, "Orbit clockwise, seen from above");
  command.add_flag("--fixed-centre", a.fixed_centre,
                   "Orbit around the middle of the whole motion; by default, the centre moves with "
                   "the character");
}

void declare_image(CommandOptions& command, Arguments& a) {
  command.group("Framing");
  add_choice<Framing>(command, "--frame", a.frame,
                      {{"full", Framing::full}, {"upper", Framing::upper}, {"head", Framing::head}},
                      "What to keep in the image in all frames: the full character, the upper body "
                      "with the arms, or the head",
                      "PART", "full");
  add_number(command, "--margin PART", a.margin,
             "Fraction of height and width kept free at each edge, up to 0.45")
      .default_str("0.08");
  command.add_option(
      "--distance LENGTH", a.distance,
      "Distance from the point it looks at; default: the shortest that frames the character");
  command.add_option("--fov ANGLE", a.fov, "Vertical field of view").default_str(a.fov);
  add_number(command, "--lens MM", a.lens,
             "The same as a focal length in millimetres, for an image 24 mm high");
  command
      .add_option("--aspect W:H", a.aspect,
                  "Aspect ratio, width by height, used for framing; written to glTF when filming a "
                  "motion or if given")
      .default_str(a.aspect);
}

void declare_movement(CommandOptions& command, Arguments& a) {
  command.group("Movement");
  command.add_option(
      "--smooth TIME", a.smooth,
      "Smoothing time of the path and the facing; 0: no smoothing [0.5s, an orbit 1s]");
  command.add_option("--dead-zone LENGTH", a.dead_zone,
                     "Distance the followed joint may move before the camera follows [0]");
  command.group("Keys and scenes");
  add_rate(command, "--rate", a.rate,
           "Frame rate of the result; default: that of the keys' file or of the scene's keys");
  command.add_option("--camera NAME", a.camera, "Camera of a scene, by name or index");
}

void declare_output(CommandOptions& command, Arguments& a) {
  command.group("Output");
  add_choice<Format>(command, "--format", a.format, {{"cam", Format::cam}, {"glb", Format::glb}},
                     "cam or glb; default: from the output's extension", "FORMAT", "")
      .default_str("");
  add_orientation_option(command, a.orientation);
  command.add_option(
      "--into IN.glb", a.into,
      "Write this glTF file as GLB, with the camera added to its scene and animation");
  command.add_option("--name NAME", a.name, "glTF: name of the camera").default_str(a.name);
  add_whole(command, "--clip", a.clip,
            "--into a file with several animations: index of the one to add the camera to; "
            "default: the first",
            0, 1000000);
}

}  // namespace

void declare(CommandOptions& command, Arguments& arguments) {
  command
      .add_option("input IN", arguments.input,
                  "Camera keys (.json, formats/camera_keys/SPEC.md), a .cam file, a glTF file with "
                  "a camera, or a motion: a .anim file or a capture, read as by krok-import with "
                  "default options")
      .required();
  declare_subject(command, arguments);
  declare_place(command, arguments);
  declare_image(command, arguments);
  declare_movement(command, arguments);
  declare_output(command, arguments);
  arguments.given = [&command](const char* option) { return command.count(option) > 0; };
}

std::string ending(const Arguments& arguments) {
  const bool glb = arguments.format == Format::glb || !arguments.into.empty();
  return glb ? ".glb" : ".cam";
}

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec = spec_of("krok-cam", arguments, declare, understand, run);
  spec.summary = "Makes cameras: keyed, following, orbiting or fixed";
  spec.details = "Written as .cam or glTF, apart or added to a character.";
  spec.inputs = "IN.json|IN.cam|IN.glb|IN.anim|IN.bvh|IN.amc";
  spec.examples = {{"krok-cam shot.json -o shot.cam", "a camera from hand-written keys"},
                   {"krok-cam walk.anim --follow hips -o shot.cam",
                    "follows the hips, with the whole character in every frame"},
                   {"krok-cam walk.anim --orbit 20s --frame upper --into walk.glb -o film.glb",
                    "orbits the upper body once in 20 seconds, added to the character's file"},
                   {"krok-cam shot.cam --into walk.glb -o film.glb", "adds an existing camera"},
                   {"krok-cam film.glb -o shot.cam", "extracts it"},
                   {"krok-cam captures/*.bvh --still --view left --out-dir cameras",
                    "one camera per file, framing the whole motion from the left"}};
  spec.batch = {io::motion_endings(),
                [arguments]() -> Result<std::string> { return ending(*arguments); }};
  return spec;
}

}  // namespace krok::cli::cam
