#pragma once

#include <span>
#include <vector>

#include "camera/framing.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"

// What of a figure is to be in the picture.

namespace krok {

enum class Framing : unsigned char {
  full,   // all of it
  upper,  // from the hips up, with the arms
  head    // the head, with the neck where there is no more of it
};

// The figure as balls about its joints, whose size comes from the figure's. Joints above the hips
// that only place the figure, and props and helpers, do not count, unless there is nothing else.
struct ActorShape {
  std::vector<int> shown;     // joints that must be in the picture; not empty
  std::vector<int> body;      // all that count, to be kept clear of
  std::vector<double> radii;  // [joints], metres
  std::vector<int> parents;   // [joints], of the bones; -1 for none
};

// `clip` gives the figure's size where the reference pose has none. Codes: camera-empty (no joints
// or no frames), camera-part (no joint is known to belong to that part).
Result<ActorShape> actor_shape(const Clip& clip, const RoleMap& roles, Framing framing);

// The balls of `joints` in a frame.
void balls_of(const ActorShape& shape, std::span<const int> joints,
              std::span<const Vec3f> positions, std::vector<Ball>& balls);

// The distance of a point from the surface of the body: the nearest of all bones, with the smaller
// of the balls at their ends for a thickness. Negative within.
double distance_to_body(const ActorShape& shape, std::span<const Vec3f> positions,
                        const Vec3& point);

}  // namespace krok
