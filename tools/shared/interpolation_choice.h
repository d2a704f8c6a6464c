#pragma once

#include <string>

#include "tools/cli/option_kinds.h"

namespace krok::cli {

// How values between keys are made: on straight lines, or on cubics (positions by Hermite's,
// rotations by squad) whose velocities at the keys are 1 - tension of those between the neighbours.
struct Interpolation {
  bool hermite = false;
  double tension = 0;  // 0 to 1
};

// linear, hermite or hermite:0.5.
inline ValueKind<Interpolation> interpolation() {
  return {"interpolation",
          "linear|hermite[:TENSION]",
          [](const std::string& text) -> Result<Interpolation> {
            if (text == "linear") return Interpolation{};
            if (text == "hermite") return Interpolation{.hermite = true};
            if (text.starts_with("hermite:")) {
              const auto tension = number({0, 1}).read(text.substr(8));
              if (!tension) return tension.error();
              return Interpolation{.hermite = true, .tension = *tension};
            }
            return usage("'" + text + "' is neither linear nor hermite",
                         "write linear, hermite, or hermite:0.5 with a tension from 0 (smooth) to "
                         "1 (stops at each key)");
          },
          {"linear", "hermite"}};
}

}  // namespace krok::cli
