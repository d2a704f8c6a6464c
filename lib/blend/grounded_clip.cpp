#include "blend/grounded_clip.h"

#include "scene/frame_moment.h"

namespace krok::blend {

GroundedClip::GroundedClip(const Clip& clip, int carrier) : clip_(clip) {
  const int frames = clip.frame_count();
  places_.resize(static_cast<std::size_t>(frames));
  if (carrier < 0) {
    poses_ = pack_clip(clip);
    return;
  }
  Clip grounded = clip;
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < frames; ++f) {
    GroundFrame& place = places_[static_cast<std::size_t>(f)];
    place = ground_frame(clip, carrier, f);
    if (f > 0) {
      const double before = places_[static_cast<std::size_t>(f - 1)].heading;
      place.heading = before + wrapped(place.heading - before);
    }
    const Transform world_to_place = place.to_world().inverse();
    clip.get_pose(f, pose);
    for (Transform& joint : pose) joint = world_to_place * joint;
    grounded.set_pose(f, pose);
  }
  poses_ = pack_clip(grounded);
}

GroundFrame GroundedClip::place(double time) const {
  const FrameMoment moment = frame_moment(time, clip_.rate, clip_.frame_count());
  const auto i = static_cast<std::size_t>(moment.before);
  GroundFrame place = places_[i];
  if (moment.fraction == 0) return place;
  const GroundFrame& next = places_[i + 1];
  place.x += moment.fraction * (next.x - place.x);
  place.z += moment.fraction * (next.z - place.z);
  place.heading += moment.fraction * (next.heading - place.heading);
  return place;
}

Vec3 GroundedClip::position(int joint, double time) const {
  const FrameMoment moment = frame_moment(time, clip_.rate, clip_.frame_count());
  const auto j = static_cast<std::size_t>(joint);
  const Vec3 position = clip_.frame_positions(moment.before)[j].cast<double>();
  if (moment.fraction == 0) return position;
  const Vec3 next = clip_.frame_positions(moment.before + 1)[j].cast<double>();
  return position + moment.fraction * (next - position);
}

}  // namespace krok::blend
