#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>

#include "math/types.h"

// Reads what Assimp 5.2 reads incorrectly from 3DS files. Sources: lib3ds; M. van Velsen, "3D
// Studio File Format (3ds)".

namespace krok::assimp {

struct Max3dsCamera {
  Vec3 position = Vec3::Zero();  // Z-up
  Vec3 target = Vec3::Zero();
  double roll = 0;   // radians, about the view direction
  double lens = 50;  // millimetres

  // Radians, by 3D Studio's formula.
  double horizontal_field_of_view() const { return 2400.0 / lens * kRadiansPerDegree; }
};

// By name; unreadable cameras are skipped.
std::map<std::string, Max3dsCamera> read_3ds_cameras(std::span<const std::byte> bytes);

}  // namespace krok::assimp
