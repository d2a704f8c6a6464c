#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/roles.h"
#include "scene/skeleton.h"

// Working out in which unit and which axes a capture was written, and bringing it into Krok's frame
// (metres, +Y up, facing +Z in the reference pose). Readers of foreign formats use this.

namespace krok {

// A signed coordinate axis.
enum class Direction : unsigned char { plus_x, minus_x, plus_y, minus_y, plus_z, minus_z };

// "x", "-x", "y", ... and back; an Error (code direction-unknown) for anything else.
std::string_view direction_name(Direction direction);
Result<Direction> parse_direction(std::string_view text);
Vec3 direction_vector(Direction direction);

// How sure a guess is. `certain`: names and geometry agree, or the user said so. `likely`: geometry
// alone. `guess`: a default, for want of evidence.
enum class Confidence { guess, likely, certain };
std::string_view confidence_name(Confidence confidence);

// A unit of length as its size in metres and its name for people.
struct Unit {
  double metres = 1.0;
  std::string name = "m";
};

// m, dm, cm, mm, in, ft, and "cmu" (the unit of the CMU collection's Acclaim files and most BVH made
// from them, 0.0254 / 0.45 m); or a length such as 5.64cm. An Error (code unit-unknown) otherwise.
Result<Unit> parse_unit(std::string_view text);

struct Conventions {
  Unit unit;
  Direction up = Direction::plus_y;
  Direction forward = Direction::plus_z;
  Confidence unit_confidence = Confidence::guess;
  Confidence up_confidence = Confidence::guess;
  Confidence forward_confidence = Confidence::guess;
  // A sentence each on what the choice rests on, for the report.
  std::string unit_reason, up_reason, forward_reason;
};

// Works the conventions out from the skeleton as the file has it (reference pose in the file's unit
// and axes) and up to a few hundred sample frames of joint_to_world positions, shape
// [samples x joints], possibly empty.
Conventions detect_conventions(const Skeleton& skeleton, const RoleMap& roles,
                               std::span<const Vec3> sample_positions);

// The rotation that takes the file's axes to Krok's: up to +Y, forward to +Z. An Error (code
// direction-parallel) if up and forward lie on one axis.
Result<Quat> rotation_to_krok(Direction up, Direction forward);

}  // namespace krok
