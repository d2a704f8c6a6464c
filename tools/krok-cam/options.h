#pragma once

#include <functional>
#include <optional>
#include <string>

#include "camera/actor_camera.h"
#include "core/result.h"
#include "formats/cam/cam.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"

namespace krok::cli::cam {

enum class Format { from_name, cam, glb };
enum class View { front, three_quarter, left, right, back, top };

// The options as given on the command line.
struct Arguments {
  std::string input;
  Format format = Format::from_name;
  OrientationEncoding orientation = OrientationEncoding::xyz;
  std::string map;
  // What the camera films.
  std::string follow, orbit;
  bool still = false;
  // View direction.
  View view = View::three_quarter;
  std::string azimuth, elevation;
  AzimuthFrom facing = AzimuthFrom::start;
  bool clockwise = false, fixed_centre = false;
  // Framing.
  Framing frame = Framing::full;
  double margin = 0.08;
  std::string distance;
  std::string fov = "40deg";
  std::optional<double> lens;
  std::string aspect = "16:9";
  // Movement.
  std::string smooth, dead_zone;
  std::optional<double> rate;
  std::string camera;
  // glTF.
  std::string into;
  std::string name = "camera";
  std::optional<int> clip;

  // Whether an option such as "--fov" was given; set by declare().
  std::function<bool(const char* option)> given;
};

// Options for filming a motion.
struct FilmOptions {
  std::string follow;         // a joint or a role; empty: the joint that carries the root motion
  ActorCamera camera;         // without its joint
  bool moving_centre = true;  // false: the middle of the whole motion
  double turns = 0;           // orbit turns over the whole motion, if no turning speed is given
};

// The parsed options.
struct Options {
  std::string input, map;
  Format format = Format::from_name;
  OrientationEncoding orientation = OrientationEncoding::xyz;
  std::optional<FilmOptions> film;
  std::optional<double> rate;
  std::string camera;  // which camera of a scene; empty: the first
  std::string into, name;
  std::optional<double> aspect;  // if given
  std::optional<int> clip;
};

// The arguments keep a reference to `command`.
void declare(CommandOptions& command, Arguments& arguments);

// Code usage, and those of quantities; messages name the option.
Result<Options> understand(const Arguments& arguments);

// The output extension that the options imply, ".cam" or ".glb".
std::string ending(const Arguments& arguments);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::cam
