#include "tools/krok-cam/options.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"

namespace krok::cli::cam {

namespace {

// Options that film a motion.
const std::vector<std::string> kFilms = {"--follow", "--orbit", "--still"};

// Aspect ratio from "16:9" or "1.78".
Result<double> parse_aspect(const std::string& text) {
  const auto parts = numbers({number(kPositive), number(kPositive)}, 1, ':').read(text);
  const double ratio = !parts ? 0 : (*parts)[0] / (parts->size() > 1 ? (*parts)[1] : 1.0);
  if (ratio >= 1e-3 && ratio <= 1e3) return ratio;
  return usage(fmt::format("'{}' is not an aspect ratio", shown(text)), "write 16:9 or 1.78");
}

// "20s", "1.5turns" or "540deg".
Result<Orbit> parse_orbit(const std::string& text) {
  constexpr const char* kForms = "write 20s for the time of a turn, or 1.5turns or 540deg in all";
  std::string_view number_of_turns = text;
  for (const auto& [unit, per_turn] : {std::pair("turns", 1.0), {"turn", 1.0}, {"deg", 360.0}}) {
    if (!number_of_turns.ends_with(unit)) continue;
    number_of_turns.remove_suffix(std::string_view(unit).size());
    const auto count = parse_finite(trimmed(number_of_turns));
    if (count && *count > 0 && *count <= 1e4) return Orbit{.turns = *count / per_turn};
    return usage(fmt::format("'{}' is not a number of turns", shown(text)), kForms);
  }
  auto period = seconds({1e-3}).read(text);
  if (period && !parse_finite(text)) return Orbit{.period = *period};
  Error error = period ? usage(fmt::format("'{}' has no unit", shown(text))) : period.error();
  error.hint = kForms;
  return error;
}

ValueKind<double> field_of_view() {
  ValueKind<double> kind = angle({3, 179});
  kind.read = [read = kind.read](const std::string& text) -> Result<double> {
    auto value = read(text);
    if (!value && text.ends_with("mm")) {
      Error error = std::move(value).error();
      error.hint = fmt::format("a focal length is --lens {}", text);
      return error;
    }
    return value;
  };
  return kind;
}

void declare_subject(CommandOptions& command, Options& o) {
  command.group("Filming a motion");
  command
      .add_option("--follow JOINT", o.follow,
                  "Follow a joint, given by name or role: hips, chest, head, left_hand")
      .not_with({"--orbit", "--still"});
  command
      .add("--orbit", o.orbit, ValueKind<Orbit>{"orbit", "TIME", parse_orbit, {}},
           "Orbit the character: 20s is the time of one turn, 1.5turns is the number of turns over "
           "the whole motion")
      .not_with("--still");
  command.add_flag("--still", o.still, "Static camera that shows the whole motion");
  add_map_option(command, o.map).only_with(kFilms);
}

void declare_place(CommandOptions& command, Options& o) {
  command.group("View direction");
  command.only_with(kFilms);
  ValueKind<View> view = choice<View>({{"front", View::front},
                                       {"three-quarter", View::three_quarter},
                                       {"left", View::left},
                                       {"right", View::right},
                                       {"back", View::back},
                                       {"top", View::top}});
  view.name = "view";
  command.add("--view VIEW", o.view, view,
              "front, three-quarter (between the character's front and left), left, right, back or "
              "top; an orbit starts there",
              "three-quarter");
  command.add("--azimuth", o.azimuth, angle(),
              "The same as an angle: 0 sees the character's front, 90deg its left side");
  command
      .add("--elevation", o.elevation, angle({-90, 90}),
           "Camera elevation; 90deg looks straight down [10deg]")
      .not_with("--view top");
  command.add(
      "--facing WHAT", o.facing,
      choice<AzimuthFrom>({{"start", AzimuthFrom::start},
                           {"actor", AzimuthFrom::actor},
                           {"world", AzimuthFrom::world}}),
      "What counts as the front: the facing at the start, the facing in each frame (actor), "
      "or +Z (world)",
      "start");
  command.add_flag("--clockwise", o.clockwise, "Orbit clockwise, seen from above")
      .only_with("--orbit");
  command
      .add_flag("--fixed-centre", o.fixed_centre,
                "Orbit around the middle of the whole motion; by default, the centre moves with "
                "the character")
      .only_with("--orbit");
}

void declare_image(CommandOptions& command, Options& o) {
  command.group("Framing");
  command.only_with(kFilms);
  command.add(
      "--frame PART", o.frame,
      choice<Framing>({{"full", Framing::full},
                       {"upper", Framing::upper},
                       {"head", Framing::head},
                       {"joint", Framing::joint}}),
      "What to keep in the image in all frames: the full character, the upper body with the "
      "arms, the head, or the joint of --follow with its neighbours",
      "full");
  command.add("--margin PART", o.margin, number({0, 0.45}),
              "Fraction of height and width kept free at each edge, up to 0.45", "0.08");
  command.add(
      "--distance", o.distance, length({0, 1e4, true}),
      "Distance from the point it looks at; default: the shortest that frames the character");
  command.add("--fov", o.fov, field_of_view(), "Vertical field of view", "40deg")
      .not_with("--lens");
  command.add("--lens MM", o.lens, number({0.1, 1e5}, "mm"),
              "The same as a focal length in millimetres, for an image 24 mm high");
  command.only_with({});
  command.add("--aspect", o.aspect, ValueKind<double>{"ratio", "W:H", parse_aspect, {}},
              "Aspect ratio, width by height, used for framing; written to glTF when filming a "
              "motion or if given",
              "16:9");
}

void declare_movement(CommandOptions& command, Options& o) {
  command.group("Movement");
  command.only_with({"--follow", "--orbit"});
  command.add("--smooth", o.smooth, seconds(),
              "Smoothing time of the path and the facing; 0: no smoothing [0.5s, an orbit 1s]");
  command.add("--dead-zone", o.dead_zone, length(kNotNegative),
              "Distance the followed joint may move before the camera follows [0]");
  command.group("Keys and scenes");
  command
      .add("--rate", o.rate, rate(),
           "Frame rate of the result; default: that of the keys' file or of the scene's keys")
      .not_with(kFilms);
  command
      .add("--interpolation", o.interpolation, interpolation(),
           "Between all keys of a keys' file, in place of what it says: linear, or hermite with a "
           "tension (0, smooth, to 1, which stops at each key)")
      .not_with(kFilms);
  command.add_option("--camera NAME", o.camera, "Camera of a scene, by name or index")
      .not_with(kFilms);
}

void declare_output(CommandOptions& command, Options& o) {
  command.group("Output");
  command.add("--format FORMAT", o.format,
              choice<Format>({{"cam", Format::cam}, {"glb", Format::glb}}),
              "cam or glb; default: from the output's extension");
  add_orientation_option(command, o.orientation);
  command
      .add_option("--into IN.glb", o.into,
                  "Write this glTF file as GLB, with the camera added to its scene and animation")
      .not_with("--format cam");
  command.add_option("--name NAME", o.name, "glTF: name of the camera").default_str("camera");
  command
      .add_option("--clip NAME", o.clip,
                  "--into a file with several animations: name or number from 0 of the one to add "
                  "the camera to; default: the first")
      .only_with("--into");
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option("input IN", o.input,
                  "Camera keys (.json, formats/camera_keys/SPEC.md), a .cam file, a glTF file with "
                  "a camera, or a motion: a .anim file or a capture, read as by krok-import with "
                  "default options")
      .required();
  declare_subject(command, o);
  declare_place(command, o);
  declare_image(command, o);
  declare_movement(command, o);
  declare_output(command, o);
  o.given = [&command](const char* option) { return command.count(option) > 0; };
}

// What the options say of values that they do not name.
Status check(const Options& o) {
  if (o.azimuth && o.view != View::top && o.given("--view")) {
    return usage("--view and --azimuth exclude each other", "leave one of them out");
  }
  if (o.still && o.facing == AzimuthFrom::actor) {
    return usage("--facing actor is for a moving camera");
  }
  if (o.name.empty()) return usage("--name is empty");
  if (o.frame == Framing::joint && o.follow.empty()) {
    return usage("--frame joint is for --follow", "name the joint with --follow");
  }
  return {};
}

}  // namespace

std::optional<FilmOptions> film_of(const Options& o) {
  constexpr double kSensorHeight = 24;  // millimetres
  constexpr double kUsualElevation = 10 * kRadiansPerDegree;
  // Seen from the top, the character faces up in the image.
  constexpr std::array kAzimuths = {0.0, 45.0, 90.0, -90.0, 180.0, 180.0};
  if (o.follow.empty() && !o.orbit && !o.still) return std::nullopt;
  FilmOptions film;
  ActorCamera& camera = film.camera;
  camera.aspect = o.aspect;
  camera.azimuth =
      o.azimuth.value_or(kAzimuths[static_cast<std::size_t>(o.view)] * kRadiansPerDegree);
  camera.elevation = o.elevation.value_or(o.view == View::top ? kPi / 2 : kUsualElevation);
  camera.azimuth_from = o.facing;
  camera.framing = o.frame;
  camera.margin = o.margin;
  if (o.distance) camera.distance = *o.distance;
  camera.field_of_view = o.lens ? 2 * std::atan(kSensorHeight / 2 / *o.lens) : o.fov;
  if (o.orbit) {
    const double sign = o.clockwise ? -1 : 1;
    film.turns = sign * o.orbit->turns;
    if (o.orbit->period > 0) camera.turning = sign * 2 * kPi / o.orbit->period;
    camera.smoothing = 1;
  }
  if (o.smooth) camera.smoothing = *o.smooth;
  if (o.dead_zone) camera.dead_zone = *o.dead_zone;
  film.moving_centre = !o.still && !o.fixed_centre;
  film.follow = o.follow;
  return film;
}

std::string ending(const Options& options) {
  const bool glb = options.format == Format::glb || !options.into.empty();
  return glb ? ".glb" : ".cam";
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-cam", options, declare, check, run);
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
                [options]() -> Result<std::string> { return ending(*options); }};
  return spec;
}

}  // namespace krok::cli::cam
