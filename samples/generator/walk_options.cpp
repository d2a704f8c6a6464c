#include "samples/generator/walk_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace krok::samples {

Status check(const WalkOptions& options) {
  struct Range {
    const char* name;
    double value, lowest, highest;
    const char* unit;
  };
  const Range ranges[] = {
      {"stature", options.stature, 0.5, 2.5, " m"},
      {"number of steps", static_cast<double>(options.steps), 1, 1000, ""},
      {"step length", options.step_length, 0, 0.55 * options.stature, " m"},
      {"step width", options.step_width, 0.04, 0.5, " m"},
      {"turn", options.turn, -0.8, 0.8, " rad"},
      {"rise", options.rise, -0.14 * options.stature, 0.14 * options.stature, " m"},
      {"cadence", options.cadence == 0 ? 100 : options.cadence, 40, 200, " steps/min"},
      {"rate", options.rate, 1, 1000, " fps"},
      {"angle noise", options.noise_angle, 0, 0.5, " rad"},
      {"position noise", options.noise_position, 0, 0.5, " m"},
  };
  for (const Range& range : ranges) {
    if (range.value >= range.lowest && range.value <= range.highest) continue;
    return Error("walk-option",
                 fmt::format("{} is {:.6g}{}, outside {:.6g} to {:.6g}", range.name, range.value,
                             range.unit, range.lowest, range.highest),
                 "give a value within the range");
  }
  if (options.rise != 0 && options.step_length < 0.165 * options.stature) {
    return Error(
        "walk-option",
        fmt::format("steps of {:.3g} m are too short to gain height: the foot needs {:.3g} m",
                    options.step_length, 0.165 * options.stature),
        "use longer steps, or no rise");
  }
  return {};
}

double cadence_of(const WalkOptions& options) {
  if (options.cadence > 0) return options.cadence;
  const bool on_stairs = options.rise != 0 && options.ground == Ground::stairs;
  return std::clamp(options.step_length / 0.0064, on_stairs ? 90.0 : 70.0, 140.0);
}

}  // namespace krok::samples
