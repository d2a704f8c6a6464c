#include "motion/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/euler.h"
#include "math/quaternion.h"
#include "motion/ground_frame.h"

namespace krok {

void move_clip(const Transform& world_to_world, Clip& clip) {
  const Transform& move = world_to_world;
  const bool turns = move.orientation.vec().squaredNorm() > 0;
  for (Vec3f& position : clip.positions) position = (move * position.cast<double>()).cast<float>();
  if (!turns) return;
  for (Quatf& orientation : clip.orientations) {
    orientation =
        normalized_or_identity(move.orientation * orientation.cast<double>()).cast<float>();
  }
}

Transform to_origin(const Clip& clip, int carrier) {
  Transform move;
  if (clip.frame_count() == 0) return move;
  const GroundFrame place = ground_frame(clip, carrier, 0);
  move.position = Vec3(-place.x, 0, -place.z);
  return move;
}

Transform turned_about_start(const Clip& clip, int carrier, double angle) {
  Transform move;
  if (clip.frame_count() == 0 || angle == 0) return move;
  const GroundFrame place = ground_frame(clip, carrier, 0);
  const Vec3 centre(place.x, 0, place.z);
  move.orientation = axis_rotation(Axis::y, angle);
  move.position = centre - move.orientation * centre;
  return move;
}

Transform facing_at_start(const Clip& clip, int carrier, double heading) {
  if (clip.frame_count() == 0) return {};
  return turned_about_start(clip, carrier,
                            wrapped(heading - ground_frame(clip, carrier, 0).heading));
}

Transform onto_ground(const Clip& clip, std::span<const int> joints) {
  Transform move;
  float lowest = std::numeric_limits<float>::infinity();
  for (int f = 0; f < clip.frame_count(); ++f) {
    const auto positions = clip.frame_positions(f);
    for (const int j : joints)
      lowest = std::min(lowest, positions[static_cast<std::size_t>(j)].y());
  }
  if (std::isfinite(lowest)) move.position.y() = -static_cast<double>(lowest);
  return move;
}

Status scale_clip(double factor, Clip& clip) {
  if (!(factor > 0) || !std::isfinite(factor)) {
    return Error("motion-scale", fmt::format("cannot scale a motion by {}", factor),
                 "the factor must be a positive number");
  }
  const auto scaled = [&](const Vec3f& position) {
    return Vec3f((factor * position.cast<double>()).cast<float>());
  };
  const bool fits =
      std::ranges::all_of(clip.positions,
                          [&](const Vec3f& position) { return scaled(position).allFinite(); }) &&
      std::ranges::all_of(clip.skeleton.reference, [&](const Transform& joint) {
        return (factor * joint.position).cast<float>().allFinite();
      });
  if (!fits) {
    return Error("motion-scale",
                 fmt::format("positions scaled by {} exceed the range of a float", factor));
  }
  for (Vec3f& position : clip.positions) position = scaled(position);
  for (Transform& joint : clip.skeleton.reference) joint.position *= factor;
  return {};
}

double reference_height(const Skeleton& skeleton) {
  if (skeleton.empty()) return 0;
  const auto [low, high] = std::ranges::minmax_element(
      skeleton.reference, {}, [](const Transform& joint) { return joint.position.y(); });
  return high->position.y() - low->position.y();
}

}  // namespace krok
