#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

// Detects the unit and axes of a capture and converts them to Krok's frame (metres, +Y up, facing
// +Z in the reference pose). For readers of foreign formats.

namespace krok {

// A signed coordinate axis.
enum class Direction : unsigned char { plus_x, minus_x, plus_y, minus_y, plus_z, minus_z };

// "x", "-x", "y", ... and the inverse, which also takes "+x"; an Error (code direction-unknown) for
// other text.
std::string_view direction_name(Direction direction);
Result<Direction> parse_direction(std::string_view text);
Vec3 direction_vector(Direction direction);

// Confidence of a detected value. `certain`: several indications agree, or given by the user.
// `likely`: a single indication, or a less clear one. `guess`: a default, or conflicting evidence.
enum class Confidence { guess, likely, certain };
std::string_view confidence_name(Confidence confidence);

// A unit of length: its size in metres and its display name.
struct Unit {
  double metres = 1.0;
  std::string name = "m";
};

// Parses m, dm, cm, mm, in, ft, "cmu" (the unit of the CMU collection's Acclaim files and of most
// BVH files converted from them, 0.0254 / 0.45 m), or a length such as 5.64cm. An Error (code
// unit-unknown) otherwise.
Result<Unit> parse_unit(std::string_view text);

struct Conventions {
  Unit unit;
  Direction up = Direction::plus_y;
  Direction forward = Direction::plus_z;
  // Axes of the reference pose. They differ from `up` and `forward` if its bones show it (such as a
  // skeleton stored y-up whose root rotates it upright in a z-up world in every frame). If the
  // reference pose is not upright, they are the axes of its pelvis, so that the hips face as they
  // do in the motion. rotation_to_krok(reference_up, reference_forward) converts the reference
  // pose, so that it too is upright and faces +Z. Axes given by the user apply to both.
  Direction reference_up = Direction::plus_y;
  Direction reference_forward = Direction::plus_z;
  Confidence unit_confidence = Confidence::guess;
  Confidence up_confidence = Confidence::guess;
  Confidence forward_confidence = Confidence::guess;
  // One sentence each on the evidence, for the report.
  std::string unit_reason, up_reason, forward_reason;
  // What the data say against given axes; empty: nothing.
  std::string up_doubt, forward_doubt;
};

// Detects the conventions from the skeleton (reference pose in the file's unit and axes) and up to
// a few hundred sample frames of joint_to_world positions, shape [samples x joints], possibly
// empty. Never fails: non-finite values are skipped, and what the data does not show is set to a
// default with confidence `guess`.
//
// Up: of the six signed axes the one that explains the samples best: along which the head is above
// the feet, the lowest joint is at 0 and keeps its height while the character travels, the left and
// right side are level, and the reference pose stands. It is certain only if the reference pose
// stands and agrees, or if the motion shows clearly that the reference pose's axis is level.
// Without samples: that of the reference pose. Forward: left x up in the
// reference pose, checked against the toes; the default if the reference pose is not upright along
// the motion's up axis, so that all takes of a skeleton agree. Unit: the one that gives a body
// height, computed from leg and spine lengths, closest to an adult's 1.72 m, with a penalty for
// rarer units, which a height alone does not make certain. Defaults: +Y up without hips and head;
// +Z forward without left and right limbs (-Y if up is along z); without legs and arms the first of
// m, cm and mm that gives a size of at most 10 m, or mm.
Conventions detect_conventions(const Skeleton& skeleton, const RoleMap& roles,
                               std::span<const Vec3> sample_positions);

// The rotation from the file's axes to Krok's: up to +Y, forward to +Z. An Error (code
// direction-parallel) if up and forward are parallel.
Result<Quat> rotation_to_krok(Direction up, Direction forward);

}  // namespace krok
