#pragma once

#include <functional>
#include <optional>
#include <string>

#include "camera/actor_camera.h"
#include "core/result.h"
#include "formats/cam/cam.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::cam {

enum class Format { from_name, cam, glb };
enum class View { front, three_quarter, left, right, back, top };

// The time of one turn in seconds, or the number of turns over the whole motion.
struct Orbit {
  double period = 0, turns = 0;
};

struct Options {
  std::string input, map;
  Format format = Format::from_name;
  OrientationEncoding orientation = OrientationEncoding::xyz;
  // What the camera films.
  std::string follow;
  std::optional<Orbit> orbit;
  bool still = false;
  // View direction.
  View view = View::three_quarter;
  std::optional<double> azimuth, elevation;  // radians
  AzimuthFrom facing = AzimuthFrom::start;
  bool clockwise = false, fixed_centre = false;
  // Framing.
  Framing frame = Framing::full;
  double margin = 0;
  std::optional<double> distance;              // metres
  std::optional<Interpolation> interpolation;  // of all keys
  double fov = 0;                              // radians
  std::optional<double> lens;                  // millimetres
  double aspect = 0;
  // Movement.
  std::optional<double> smooth, dead_zone;  // seconds, metres
  std::optional<double> rate;
  std::string camera;  // which camera of a scene; empty: the first
  // glTF.
  std::string into;
  std::string name = "camera";
  std::string clip;

  // Whether an option such as "--aspect" was given; set by declare().
  std::function<bool(const char* option)> given;
};

// Options for filming a motion.
struct FilmOptions {
  std::string follow;         // a joint or a role; empty: the joint that carries the root motion
  ActorCamera camera;         // without its joint
  bool moving_centre = true;  // false: the middle of the whole motion
  double turns = 0;           // orbit turns over the whole motion, if no turning speed is given
};

// Empty if no motion is filmed.
std::optional<FilmOptions> film_of(const Options& options);

// The output extension that the options imply, ".cam" or ".glb".
std::string ending(const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Makes or reads the camera and writes it. Codes cam-input, cam-format, cam-joint, and those of the
// functions it calls.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::cam
