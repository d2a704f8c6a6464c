#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>

#include "math/types.h"

// What Assimp 5.2 reads wrong in 3DS files, read from the bytes themselves. The format: what is
// known of Autodesk's chunks from lib3ds and M. van Velsen's "3D Studio File Format (3ds)".

namespace krok::assimp {

struct Max3dsCamera {
  Vec3 position = Vec3::Zero();  // Z-up
  Vec3 target = Vec3::Zero();
  double roll = 0;   // radians, about where it looks
  double lens = 50;  // millimetres

  // 3D Studio's own relation of the two; radians.
  double horizontal_field_of_view() const { return 2400.0 / lens * kRadiansPerDegree; }
};

// By name; those that can be read.
std::map<std::string, Max3dsCamera> read_3ds_cameras(std::span<const std::byte> bytes);

}  // namespace krok::assimp
