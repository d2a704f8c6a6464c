#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "capture/conventions.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

// What the detection of conventions measures on a figure: directions of the body, its height, and
// where its lowest joint is, in a file's own unit and axes.

namespace krok::actor {

using Positions = std::span<const Vec3>;  // [joints]

// The signed axis nearest to a vector, and how near: the cosine of the angle between them.
struct NearestAxis {
  Direction direction = Direction::plus_y;
  double cosine = 0;
};

NearestAxis nearest_axis(const Vec3& v);
Direction opposite(Direction d);
bool on_one_axis(Direction a, Direction b);

// "+y", "-y".
std::string signed_name(Direction d);

// The unit vector from one place to another, nothing where they are one.
std::optional<Vec3> direction_between(const Vec3& from, const Vec3& to);

// The joints that tell up from down and left from right; -1 where the figure has none.
struct Landmarks {
  int hips, head, left_foot, right_foot, left_toes, right_toes;
  int left_leg, right_leg, left_arm, right_arm;

  Landmarks(const Skeleton& skeleton, const RoleMap& roles);

  bool trunk_known() const { return hips >= 0 && head >= 0; }
  bool feet_known() const { return left_foot >= 0 && right_foot >= 0; }
  bool upright_known() const { return trunk_known() && feet_known(); }

  // What body_axis() begins at.
  const char* lower_end() const { return feet_known() ? "feet" : "hips"; }
};

inline const Vec3& at(Positions pose, int joint) {
  return pose[static_cast<std::size_t>(joint)];
}

// From the feet, or from the hips where there are no two feet, to the head.
std::optional<Vec3> body_axis(Positions pose, const Landmarks& marks);

// The cosine of the angle between legs and trunk, from the feet to the hips and from there to the
// head: 1 for a figure that stands, near 0 for one on all fours.
std::optional<double> stretch(Positions pose, const Landmarks& marks);

// Where the figure faces by its left and right side, at right angles to `up`.
std::optional<Vec3> facing(Positions pose, const Landmarks& marks, Direction up);

// Where the toes point, at right angles to `up`; nothing where they point down or there are none.
std::optional<Vec3> toes_direction(Positions pose, const Landmarks& marks, Direction up);

// A skeleton, its roles and its sample frames, with what all detections need of them.
struct Evidence {
  const Skeleton& skeleton;
  const RoleMap& roles;
  Landmarks marks;
  std::vector<Vec3> reference;    // [joints]
  std::span<const Vec3> samples;  // [samples x joints]
  std::size_t sample_count = 0;

  // How the reference pose stands: the axis of trunk and legs together, or nothing where they fold
  // (zero rotations are no natural pose in some rigs).
  std::optional<NearestAxis> reference_stands;

  Evidence(const Skeleton& s, const RoleMap& r, std::span<const Vec3> sample_positions);

  Positions sample(std::size_t index) const {
    return samples.subspan(index * reference.size(), reference.size());
  }
};

// How tall the figure is, from the lengths of its bones, so that the pose does not matter; 0 where
// legs, arms and spine are missing.
double height_in(const Evidence& evidence, Positions pose);

// The height in the reference pose, or in the first sample where that one has none.
double height_of(const Evidence& evidence);

// Where the figure is along `up`, as shares of its height; places are those of the median sample.
struct Heights {
  double lowest = 0;  // the lowest joint: 0 for a figure on the ground of its world
  double hips = 0;    // from the lowest joint
  // Between which the lowest joint is in four of five samples: little along the true vertical, for
  // figures on a floor, however far they travel.
  double spread = 0;
};

// Nothing without samples, hips or a height.
std::optional<Heights> heights_along(const Evidence& evidence, Direction up);

// The detections; each fills in its part of `found`, up first.
void detect_up(const Evidence& evidence, Conventions& found);
void detect_forward(const Evidence& evidence, Conventions& found);
void detect_reference_axes(const Evidence& evidence, Conventions& found);
void detect_unit(const Evidence& evidence, Conventions& found);

}  // namespace krok::actor
