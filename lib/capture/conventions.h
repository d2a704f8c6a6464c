#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "roles/roles.h"
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

// m, dm, cm, mm, in, ft, and "cmu" (the unit of the CMU collection's Acclaim files and most BVH
// made from them, 0.0254 / 0.45 m); or a length such as 5.64cm. An Error (code unit-unknown)
// otherwise.
Result<Unit> parse_unit(std::string_view text);

struct Conventions {
  Unit unit;
  Direction up = Direction::plus_y;
  Direction forward = Direction::plus_z;
  // The axes of the reference pose where its bones show that they are others than the motion's (a
  // figure stored y-up whose root turns it upright in a z-up world in every frame); of a reference
  // pose that does not stand at all those of its pelvis, so that the hips face where they do in the
  // motion; otherwise equal to `up` and `forward`. The reference pose is brought to Krok's frame by
  // rotation_to_krok(reference_up, reference_forward), so that it stands upright and faces +Z too;
  // a reader whose user named the axes sets them alike.
  Direction reference_up = Direction::plus_y;
  Direction reference_forward = Direction::plus_z;
  Confidence unit_confidence = Confidence::guess;
  Confidence up_confidence = Confidence::guess;
  Confidence forward_confidence = Confidence::guess;
  // A sentence each on what the choice rests on, for the report.
  std::string unit_reason, up_reason, forward_reason;
};

// Works the conventions out from the skeleton as the file has it (reference pose in the file's unit
// and axes) and up to a few hundred sample frames of joint_to_world positions, shape
// [samples x joints], possibly empty. Never fails: values that are not finite are passed over, and
// what the figure does not show is a default with confidence `guess`.
//
// Up: where the head is above the feet in most samples, or in the reference pose for want of
// samples; a motion that is upside down does not turn over an upright reference pose, nor one that
// lies in most samples a world in which it stands in others. Forward: to
// the left of the right side (left x up) in the reference pose, held against the toes; in the first
// sample where the reference pose does not stand as the motion does. Unit: the one that makes the
// figure, from the lengths of its legs and spine, most like an adult of 1.5 to 2.0 m.
// For figures that are not humanoid +Y up, +Z forward and a unit that gives a size below 10 m.
Conventions detect_conventions(const Skeleton& skeleton, const RoleMap& roles,
                               std::span<const Vec3> sample_positions);

// The rotation that takes the file's axes to Krok's: up to +Y, forward to +Z. An Error (code
// direction-parallel) if up and forward lie on one axis.
Result<Quat> rotation_to_krok(Direction up, Direction forward);

}  // namespace krok
