#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "core/numbers.h"
#include "core/quantity.h"
#include "tools/cli/usage.h"
#include "tools/krok-cam/options.h"

namespace krok::cli::cam {

namespace {

constexpr double kSensorHeight = 24;  // millimetres
constexpr double kUsualElevation = 10 * kRadiansPerDegree;

template <typename T>
Result<T> named(Result<T> value, const char* option) {
  if (value) return value;
  Error error = std::move(value).error();
  error.message = fmt::format("{}: {}", option, error.message);
  return error;
}

Result<double> positive(Result<double> value, const std::string& text, const char* option,
                        bool or_zero = false) {
  value = named(std::move(value), option);
  if (!value || *value > 0 || (or_zero && *value == 0)) return value;
  return usage(fmt::format("{} {} is not greater than 0", option, text));
}

// In seconds.
Result<double> seconds(const std::string& text, const char* option, bool or_zero) {
  auto time = named(parse_clip_time(text), option);
  if (!time) return time.error();
  if (time->in_frames) {
    return usage(fmt::format("{} {}: expected a time in seconds", option, text));
  }
  return positive(time->value, text, option, or_zero);
}

// Aspect ratio from "16:9" or "1.78".
Result<double> parse_aspect(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto width = parse_finite(text.substr(0, colon));
  const auto height =
      colon == std::string::npos ? std::optional(1.0) : parse_finite(text.substr(colon + 1));
  if (width && height && *width > 0 && *height > 0 && *width / *height >= 1e-3 &&
      *width / *height <= 1e3) {
    return *width / *height;
  }
  return usage(fmt::format("--aspect {}: invalid aspect ratio", text), "write 16:9 or 1.78");
}

Status understand_view(const Arguments& a, ActorCamera& camera) {
  // Seen from the top, the character faces up in the image.
  constexpr std::array kAzimuths = {0.0, 45.0, 90.0, -90.0, 180.0, 180.0};
  camera.azimuth = kAzimuths[static_cast<std::size_t>(a.view)] * kRadiansPerDegree;
  camera.elevation = a.view == View::top ? kPi / 2 : kUsualElevation;
  if (!a.azimuth.empty()) {
    if (a.given("--view") && a.view != View::top) {
      return usage("--view and --azimuth cannot be combined");
    }
    const auto azimuth = named(parse_angle(a.azimuth), "--azimuth");
    if (!azimuth) return azimuth.error();
    camera.azimuth = *azimuth;
  }
  if (!a.elevation.empty()) {
    if (a.view == View::top) return usage("--view top and --elevation cannot be combined");
    const auto elevation = named(parse_angle(a.elevation), "--elevation");
    if (!elevation) return elevation.error();
    if (std::abs(*elevation) > kPi / 2 + 1e-9) {
      return usage(fmt::format("--elevation {} is not from -90 to 90 degrees", a.elevation));
    }
    camera.elevation = *elevation;
  }
  camera.azimuth_from = a.facing;
  return {};
}

Status understand_image(const Arguments& a, ActorCamera& camera) {
  camera.framing = a.frame;
  if (!(a.margin >= 0 && a.margin <= 0.45)) {
    return usage(fmt::format("--margin {} is not in 0 to 0.45", readable(a.margin)));
  }
  camera.margin = a.margin;
  if (!a.distance.empty()) {
    const auto distance = positive(parse_length(a.distance), a.distance, "--distance");
    if (!distance) return distance.error();
    if (*distance > 1e4) return usage("--distance is more than 10 km");
    camera.distance = *distance;
  }
  if (a.lens) {
    if (a.given("--fov")) return usage("--fov and --lens cannot be combined");
    if (!(*a.lens >= 0.1 && *a.lens <= 1e5)) {
      return usage(fmt::format("--lens {} is not in 0.1 to 100000 mm", readable(*a.lens)));
    }
    camera.field_of_view = 2 * std::atan(kSensorHeight / 2 / *a.lens);
  } else {
    const auto fov = named(parse_angle(a.fov), "--fov");
    if (!fov) return fov.error();
    if (!(*fov >= 1e-4 && *fov <= kPi - 1e-4)) {
      return usage(fmt::format("--fov {} is not between 0 and 180 degrees", a.fov));
    }
    camera.field_of_view = *fov;
  }
  return {};
}

Status understand_orbit(const Arguments& a, FilmOptions& film) {
  constexpr std::string_view kTurns = "turns", kTurn = "turn";
  std::string_view text = a.orbit;
  bool turns = false;
  for (const std::string_view unit : {kTurns, kTurn}) {
    if (turns || !text.ends_with(unit)) continue;
    turns = true;
    text.remove_suffix(unit.size());
    if (text.ends_with(' ')) text.remove_suffix(1);
  }
  const double sign = a.clockwise ? -1 : 1;
  if (turns) {
    const auto count = parse_finite(text);
    if (!count || !(*count > 0 && *count <= 1e4)) {
      return usage(fmt::format("--orbit {}: invalid number of turns", a.orbit),
                   "write 20s or 1.5turns");
    }
    film.turns = sign * *count;
    return {};
  }
  const auto period = seconds(a.orbit, "--orbit", false);
  if (!period) return period.error();
  if (*period < 1e-3) return usage("--orbit: a turn must take at least 1 ms");
  film.camera.turning = sign * 2 * kPi / *period;
  return {};
}

Status understand_movement(const Arguments& a, FilmOptions& film) {
  if (!a.orbit.empty()) {
    if (Status status = understand_orbit(a, film); !status) return status;
    film.camera.smoothing = 1;
  }
  film.moving_centre = !a.still && !a.fixed_centre;
  film.follow = a.follow;
  if (!a.smooth.empty()) {
    const auto smooth = seconds(a.smooth, "--smooth", true);
    if (!smooth) return smooth.error();
    film.camera.smoothing = *smooth;
  }
  if (!a.dead_zone.empty()) {
    const auto zone = positive(parse_length(a.dead_zone), a.dead_zone, "--dead-zone", true);
    if (!zone) return zone.error();
    film.camera.dead_zone = *zone;
  }
  return {};
}

// Options that have no effect without another are errors.
Status check_needs(const Arguments& a, bool films) {
  constexpr std::array kOfFilms = {"--view",  "--azimuth", "--elevation", "--facing",
                                   "--frame", "--margin",  "--distance",  "--fov",
                                   "--lens",  "--smooth",  "--dead-zone", "--map"};
  for (const char* option : kOfFilms) {
    if (!films && a.given(option)) {
      return usage(fmt::format("{} is only for filming a motion", option),
                   "add --follow, --orbit or --still");
    }
  }
  for (const char* option : {"--clockwise", "--fixed-centre"}) {
    if (a.orbit.empty() && a.given(option)) {
      return usage(fmt::format("{} is for --orbit", option));
    }
  }
  for (const char* option : {"--smooth", "--dead-zone"}) {
    if (a.still && a.given(option)) {
      return usage(fmt::format("{} is for a moving camera", option));
    }
  }
  if (a.still && a.facing == AzimuthFrom::actor) {
    return usage("--facing actor is for a moving camera");
  }
  if (a.into.empty() && a.given("--clip")) return usage("--clip is for --into");
  if (!a.into.empty() && a.format == Format::cam) {
    return usage("--into writes a GLB and cannot be combined with --format cam");
  }
  if (films && a.rate) {
    return usage("--rate is for keys and scenes; when filming, the camera has the motion's rate");
  }
  if (films && !a.camera.empty()) return usage("--camera is for scenes");
  return {};
}

}  // namespace

Result<Options> understand(const Arguments& a) {
  const int ways = (a.follow.empty() ? 0 : 1) + (a.orbit.empty() ? 0 : 1) + (a.still ? 1 : 0);
  if (ways > 1) return usage("--follow, --orbit and --still cannot be combined");
  if (Status status = check_needs(a, ways == 1); !status) return status.error();
  Options options;
  options.input = a.input;
  options.map = a.map;
  options.format = a.format;
  options.orientation = a.orientation;
  options.rate = a.rate;
  options.camera = a.camera;
  options.into = a.into;
  options.name = a.name;
  options.clip = a.clip;
  const auto aspect = parse_aspect(a.aspect);
  if (!aspect) return aspect.error();
  if (a.given("--aspect")) options.aspect = *aspect;
  if (a.name.empty()) return usage("--name is empty");
  if (ways == 0) return options;
  FilmOptions& film = options.film.emplace();
  film.camera.aspect = *aspect;
  if (Status status = understand_view(a, film.camera); !status) return status.error();
  if (Status status = understand_image(a, film.camera); !status) return status.error();
  if (Status status = understand_movement(a, film); !status) return status.error();
  return options;
}

}  // namespace krok::cli::cam
