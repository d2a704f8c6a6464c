#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "math/quaternion.h"
#include "timeline/mix.h"
#include "unit/blend/blended_walks.h"

// Timelines for tests: walks with known keytimes, and a single joint that turns as told.

namespace krok::timeline {

using blend::farthest;
using blend::keyed_walk;
using blend::KeyedWalk;
using blend::quick_walk;
using blend::slow_walk;

inline Source source_of(const KeyedWalk& walk, const std::string& name = "walk") {
  return {name, &walk.clip, &walk.keys, {}};
}

inline ClipTime seconds(double value) {
  return {value, false};
}
inline ClipTime frames(int value) {
  return {static_cast<double>(value), true};
}

inline BaseItem played(int source) {
  BaseItem item;
  item.name = "item";
  item.play.source = source;
  return item;
}

inline BaseItem changed(int source, ChangeKind kind, double duration) {
  BaseItem item = played(source);
  item.change.kind = kind;
  item.change.duration = duration;
  return item;
}

inline Result<Mixed> try_mix(const Timeline& timeline, const std::vector<Source>& sources,
                             int jobs = 0) {
  return mix(timeline, sources, find_roles(sources.front().clip->skeleton), {.jobs = jobs});
}

inline Mixed mixed(const Timeline& timeline, const std::vector<Source>& sources) {
  auto result = try_mix(timeline, sources);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  if (!result) return {};
  EXPECT_TRUE(check(result->clip).ok());
  const Status status = check(result->keys, result->clip.skeleton, result->clip.duration());
  EXPECT_TRUE(status.ok()) << (status.ok() ? "" : status.error().message);
  return std::move(*result);
}

inline bool same_frame(const Clip& a, int frame_a, const Clip& b, int frame_b) {
  return std::ranges::equal(a.frame_positions(frame_a), b.frame_positions(frame_b)) &&
         std::ranges::equal(
             a.frame_orientations(frame_a), b.frame_orientations(frame_b),
             [](const Quatf& p, const Quatf& q) { return p.coeffs() == q.coeffs(); });
}

// A joint that turns about +X by angle(t), at a place of its own.
template <typename Angle>
Clip turning(double duration, double rate, const Angle& angle) {
  Clip clip;
  clip.skeleton.add("Joint", -1, {});
  clip.rate = rate;
  clip.resize(static_cast<int>(std::lround(duration * rate)) + 1);
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Transform pose{Vec3(0, 1, 0), axis_rotation(Axis::x, angle(f / rate))};
    clip.set_pose(f, std::vector<Transform>{pose});
  }
  return clip;
}

// The angle that it has turned by.
inline double angle_of(const Clip& clip, int frame) {
  const Quat q = clip.frame_orientations(frame)[0].cast<double>();
  return std::remainder(2 * std::atan2(q.x(), q.w()), 2 * kPi);
}

// Rotations to the parent, of one frame.
inline std::vector<Transform> local_of(const Clip& clip, int frame) {
  std::vector<Transform> world(clip.skeleton.names.size()), local(world.size());
  clip.get_pose(frame, world);
  world_to_local(clip.skeleton.parents, world, local);
  return local;
}

}  // namespace krok::timeline
