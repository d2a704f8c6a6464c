#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "math/transform.h"

namespace krok {

// Even travel over the ground, as an engine moves a character: a velocity that turns along.
struct RootMotion {
  Vec3 velocity = Vec3::Zero();  // metres per second, world space, at the first frame
  double turn_rate = 0;          // radians per second about +Y
};

// The origin of data and what was done to it. Written into Krok's files, so it contains nothing
// that differs between two runs on the same input: base names only, no timestamps.
struct Provenance {
  std::string tool;     // "krok-import"
  std::string version;  // "0.2.0"
  struct Source {
    std::string name;  // base name of the file, with the animation: "hero.glb#Run"
    std::string xxh3;  // sixteen hexadecimal digits
  };
  std::vector<Source> sources;
  std::vector<std::pair<std::string, std::string>> options;  // as given, in a fixed order
  std::vector<std::string> conversions;  // "unit: centimetres to metres (detected, certain)"
  std::vector<std::string> warnings;     // messages with their codes
  // Taken out of a motion that is in place (see carried_along() in motion/travel.h).
  std::optional<RootMotion> removed_root_motion = {};
};

}  // namespace krok
