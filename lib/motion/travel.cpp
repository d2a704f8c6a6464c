#include "motion/travel.h"

#include <cmath>

#include "math/euler.h"
#include "motion/ground_frame.h"

namespace krok {

namespace {

bool travels(const Clip& clip, int joint) {
  constexpr float kStillMetres = 1e-3f;
  const auto j = static_cast<std::size_t>(joint);
  Eigen::AlignedBox2f box;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Vec3f& position = clip.frame_positions(f)[j];
    box.extend(Eigen::Vector2f(position.x(), position.z()));
  }
  return box.sizes().maxCoeff() > kStillMetres;
}

// The topmost joint that travels, from the carrier upwards; the carrier if none does.
int top_traveller(const Clip& clip, int carrier) {
  int top = carrier;
  for (int j = carrier; j >= 0; j = clip.skeleton.parents[static_cast<std::size_t>(j)]) {
    if (travels(clip, j)) top = j;
  }
  return top;
}

}  // namespace

Clip in_place(const Clip& clip, int carrier, Travel removed) {
  Clip result = clip;
  const int last = clip.frame_count() - 1;
  if (last < 1) return result;
  const auto within = subtree(clip.skeleton, top_traveller(clip, carrier));
  const GroundFrame first = ground_frame(clip, carrier, 0);
  const GroundFrame end = ground_frame(clip, carrier, last);
  for (int f = 1; f <= last; ++f) {
    const GroundFrame now = ground_frame(clip, carrier, f);
    const double share = static_cast<double>(f) / last;
    const Vec3 travel = removed == Travel::all
                            ? Vec3(now.x - first.x, 0, now.z - first.z)
                            : Vec3(share * (end.x - first.x), 0, share * (end.z - first.z));
    auto positions = result.frame_positions(f);
    for (std::size_t j = 0; j < positions.size(); ++j) {
      if (within[j]) positions[j] = (positions[j].cast<double>() - travel).cast<float>();
    }
  }
  return result;
}

Clip carried_along(const Clip& clip, int carrier, const RootMotion& added) {
  Clip result = clip;
  result.provenance.removed_root_motion.reset();
  if (clip.frame_count() == 0) return result;
  const GroundFrame start = ground_frame(clip, carrier, 0);
  const Vec3 pivot(start.x, 0, start.z);
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 1; f < clip.frame_count(); ++f) {
    const double time = f / clip.rate;
    const double angle = added.turn_rate * time;
    const Quat turn = axis_rotation(Axis::y, angle);
    // The integral of the turning velocity: the chord, at the mean heading.
    const double chord = std::abs(angle) < 1e-6 ? 1 : std::sin(angle / 2) / (angle / 2);
    const Vec3 way = chord * time * (axis_rotation(Axis::y, angle / 2) * added.velocity);
    const Transform move{pivot + way - turn * pivot, turn};
    clip.get_pose(f, pose);
    for (Transform& joint : pose) joint = move * joint;
    result.set_pose(f, pose);
  }
  return result;
}

std::optional<Clip> travelling(const Clip& clip, int carrier) {
  const auto& removed = clip.provenance.removed_root_motion;
  if (!removed) return std::nullopt;
  return carried_along(clip, carrier, *removed);
}

}  // namespace krok
