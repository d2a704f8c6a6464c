#pragma once

#include <functional>
#include <optional>
#include <string>

#include "camera/actor_camera.h"
#include "core/result.h"
#include "formats/cam/cam.h"
#include "tools/common/command_options.h"

namespace krok::cam_tool {

enum class Format { from_name, cam, glb };
enum class View { front, three_quarter, left, right, back, top };

// The options as they were typed.
struct Arguments {
  std::string input;
  Format format = Format::from_name;
  OrientationEncoding orientation = OrientationEncoding::xyz;
  std::string map;
  // What it films.
  std::string follow, orbit;
  bool still = false;
  // From where.
  View view = View::three_quarter;
  std::string azimuth, elevation;
  AzimuthFrom facing = AzimuthFrom::start;
  bool clockwise = false, fixed_centre = false;
  // The picture.
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

  // Whether an option, "--fov", stands on the command line; set by declare().
  std::function<bool(const char* option)> given;
};

// What is made of a motion.
struct FilmOptions {
  std::string follow;         // a joint or a role; empty: the joint that carries the figure
  ActorCamera camera;         // without its joint
  bool moving_centre = true;  // otherwise the middle of the whole motion
  double turns = 0;           // an orbit's, over the whole motion, where its turning is not given
};

// The same, understood.
struct Options {
  std::string input, map;
  Format format = Format::from_name;
  OrientationEncoding orientation = OrientationEncoding::xyz;
  std::optional<FilmOptions> film;
  std::optional<double> rate;
  std::string camera;  // which of a scene's; empty: the first
  std::string into, name;
  std::optional<double> aspect;  // where it was given
  std::optional<int> clip;
};

// `app` is kept by the arguments.
void declare(CommandOptions& command, Arguments& arguments);

// Code usage, and those of quantities, with the option's name.
Result<Options> understand(const Arguments& arguments);

// The ending of results that the options tell, ".cam" or ".glb".
std::string ending(const Arguments& arguments);

}  // namespace krok::cam_tool
