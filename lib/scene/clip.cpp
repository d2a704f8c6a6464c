#include "scene/clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.h"
#include "core/numbers.h"
#include "math/quaternion.h"
#include "scene/frame_source.h"

namespace krok {

void Clip::resize(int frames) {
  const std::size_t count = static_cast<std::size_t>(frames) * skeleton.names.size();
  positions.resize(count, Vec3f::Zero());
  orientations.resize(count, Quatf::Identity());
}

std::span<const Vec3f> Clip::frame_positions(int frame) const {
  return row_of(positions, joint_count(), frame);
}
std::span<Vec3f> Clip::frame_positions(int frame) {
  return row_of(positions, joint_count(), frame);
}
std::span<const Quatf> Clip::frame_orientations(int frame) const {
  return row_of(orientations, joint_count(), frame);
}
std::span<Quatf> Clip::frame_orientations(int frame) {
  return row_of(orientations, joint_count(), frame);
}

void Clip::get_pose(int frame, std::span<Transform> joint_to_world) const {
  const auto p = frame_positions(frame);
  const auto q = frame_orientations(frame);
  for (std::size_t i = 0; i < p.size(); ++i) {
    joint_to_world[i] = {p[i].cast<double>(), normalized_or_identity(q[i].cast<double>())};
  }
}

void Clip::set_pose(int frame, std::span<const Transform> joint_to_world) {
  const auto p = frame_positions(frame);
  const auto q = frame_orientations(frame);
  for (std::size_t i = 0; i < p.size(); ++i) {
    p[i] = joint_to_world[i].position.cast<float>();
    q[i] = joint_to_world[i].orientation.cast<float>();
  }
}

Status check(const Clip& clip) {
  if (Status status = check(clip.skeleton); !status) return status;
  if (clip.positions.size() != clip.orientations.size() ||
      clip.positions.size() % clip.skeleton.names.size() != 0) {
    return Error("clip-shape",
                 fmt::format("{} positions and {} orientations are not whole frames of {} joints",
                             clip.positions.size(), clip.orientations.size(), clip.joint_count()));
  }
  if (Status status = check_frame_rate(clip.rate, "clip-rate"); !status) return status;
  return check_values(clip.skeleton, 0, clip.positions, clip.orientations);
}

Status check_values(const Skeleton& skeleton, int first_frame, std::span<const Vec3f> positions,
                    std::span<const Quatf> orientations) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (is_near(positions[i]) && orientations[i].coeffs().allFinite() &&
        std::abs(orientations[i].norm() - 1.0f) <= 1e-3f) {
      continue;
    }
    const std::size_t joints = skeleton.names.size();
    const auto frame = first_frame + static_cast<std::int64_t>(i / joints);
    Error error("clip-value",
                fmt::format("joint {} in frame {} is not finite, over 1e9 m away or not a rotation",
                            skeleton.names[i % joints], frame));
    error.joint = skeleton.names[i % joints];
    error.frame = frame;
    return error;
  }
  return {};
}

void fill_frames_between(Clip& clip, int first, int next) {
  const std::size_t joints = clip.skeleton.names.size();
  std::vector<Transform> world(joints), before(joints), after(joints), local(joints);
  clip.get_pose(first, world);
  world_to_local(clip.skeleton.parents, world, before);
  clip.get_pose(next, world);
  world_to_local(clip.skeleton.parents, world, after);
  for (int frame = first + 1; frame < next; ++frame) {
    const double t = static_cast<double>(frame - first) / static_cast<double>(next - first);
    for (std::size_t j = 0; j < joints; ++j) {
      local[j].position = before[j].position + t * (after[j].position - before[j].position);
      local[j].orientation = slerp(before[j].orientation, after[j].orientation, t);
    }
    local_to_world(clip.skeleton.parents, local, world);
    clip.set_pose(frame, world);
  }
}

FrameMoment frame_moment(double time, double rate, int frames) {
  const int last = frames - 1;
  const double wanted = time * rate;
  if (!(wanted > 0)) return {};  // NaN gives the first frame
  if (wanted >= last) return {last, 0};
  const int before = static_cast<int>(wanted);
  const double fraction = wanted - before;
  // Times that match a frame up to rounding give that frame, without interpolation.
  constexpr double kSameFrame = 1e-9;
  if (fraction < kSameFrame) return {before, 0};
  if (fraction > 1.0 - kSameFrame) return {before + 1, 0};
  return {before, fraction};
}

Status check_frame_rate(double rate, std::string code) {
  if (rate >= kMinRate && rate <= kMaxRate) return {};
  return Error(std::move(code),
               fmt::format("the frame rate is {}, expected {} to {} frames per second",
                           readable(rate), readable(kMinRate), readable(kMaxRate)));
}

Result<int> frames_within(double duration, double rate, int joints) {
  if (Status status = check_frame_rate(rate, "clip-rate"); !status) return status.error();
  const double frames = std::floor(duration * rate + 1e-3) + 1;
  if (!(frames * std::max(joints, 1) <= 1e8)) {
    return Error("clip-too-long", fmt::format("{} fps over {} s gives {} frames, too many to hold",
                                              rate, duration, frames));
  }
  return static_cast<int>(frames);
}

}  // namespace krok
