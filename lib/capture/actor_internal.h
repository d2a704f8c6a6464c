#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "capture/conventions.h"
#include "roles/body_frame.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

// Body measurements used to detect conventions: body directions, height, and the height of the
// lowest joint, all in the file's unit and axes.

namespace krok::actor {

using Positions = std::span<const Vec3>;  // [joints]

// The signed axis nearest to a vector, and the cosine of the angle between the two.
struct NearestAxis {
  Direction direction = Direction::plus_y;
  double cosine = 0;
};

NearestAxis nearest_axis(const Vec3& v);
Direction opposite(Direction d);
bool on_one_axis(Direction a, Direction b);

// "+y", "-y".
std::string signed_name(Direction d);

// Unit vector between two points; empty if they coincide or are not finite.
std::optional<Vec3> direction_between(const Vec3& from, const Vec3& to);

// The joints that define up and down, left and right; -1 if missing. The neck replaces a missing
// head, a foot's end site missing toes.
struct Landmarks {
  int hips, head, left_foot, right_foot, left_toes, right_toes;
  int left_leg, right_leg, left_arm, right_arm;

  Landmarks(const Skeleton& skeleton, const RoleMap& roles);

  bool trunk_known() const { return hips >= 0 && head >= 0; }
  bool feet_known() const { return left_foot >= 0 && right_foot >= 0; }
  bool sides_known() const {
    return (left_leg >= 0 && right_leg >= 0) || (left_arm >= 0 && right_arm >= 0);
  }
  bool upright_known() const { return trunk_known() && feet_known(); }

  // The start of body_axis(), for messages.
  const char* lower_end() const { return feet_known() ? "feet" : "hips"; }
};

inline const Vec3& at(Positions pose, int joint) {
  return pose[static_cast<std::size_t>(joint)];
}

// Unit vector from the midpoint of the feet to the head; from the hips unless both feet are known.
std::optional<Vec3> body_axis(Positions pose, const Landmarks& marks);

// Unit vector from right to left, from hips and shoulders; empty if these are missing.
std::optional<Vec3> side_axis(Positions pose, const Landmarks& marks);

// Facing direction derived from hips and shoulders, perpendicular to `up`; empty if these are
// missing or the body lies on its side.
std::optional<Vec3> facing(Positions pose, const Landmarks& marks, Direction up);

// Direction of the toes, perpendicular to `up`; empty if they point up or down or are missing.
std::optional<Vec3> toes_direction(Positions pose, const Landmarks& marks, Direction up);

// A skeleton, its roles and its sample frames: the input of all detections.
struct Evidence {
  const Skeleton& skeleton;
  const RoleMap& roles;
  Landmarks marks;
  std::vector<Vec3> reference;    // [joints]
  std::span<const Vec3> samples;  // [samples x joints]
  std::size_t sample_count = 0;

  // The up axis of the reference pose, from trunk and legs; empty if it is not upright (in some
  // rigs zero rotations are not a natural pose).
  std::optional<NearestAxis> reference_stands;

  Evidence(const Skeleton& s, const RoleMap& r, std::span<const Vec3> sample_positions);

  Positions sample(std::size_t index) const {
    return samples.subspan(index * reference.size(), reference.size());
  }
};

// From the reference pose; if it has no length there, from the first sample.
std::optional<Stature> stature_of(const Evidence& evidence);

// Positions along an axis in body heights; `lowest` and `hips` are medians over the samples.
struct Heights {
  double lowest = 0;  // the lowest joint; 0 if on the ground of the file's world
  double hips = 0;    // the hips above the lowest joint
  // 10th to 90th percentile range of the lowest joint: small along the true up axis on a flat
  // floor, however far the character travels.
  double spread = 0;
};

// Along each Direction, of the hips and the joints below them. Empty without samples, hips or a
// height.
std::optional<std::array<Heights, 6>> heights_of(const Evidence& evidence);

// The detections. Each sets its part of `found`; detect_up must come first.
void detect_up(const Evidence& evidence, Conventions& found);
void detect_forward(const Evidence& evidence, Conventions& found);
void detect_reference_axes(const Evidence& evidence, Conventions& found);
void detect_unit(const Evidence& evidence, Conventions& found);

}  // namespace krok::actor
