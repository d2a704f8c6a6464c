#include "motion/sample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/index.h"
#include "math/hermite.h"
#include "math/quaternion.h"

namespace krok {

namespace {

// The pose of a moment that is no frame's own.
void sample_between(const Clip& clip, const FrameMoment& moment,
                    std::span<Transform> joint_to_world, std::span<Transform> scratch) {
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  const auto world = scratch.subspan(0, joints);
  const auto first = scratch.subspan(joints, joints);
  const auto second = scratch.subspan(2 * joints, joints);
  clip.get_pose(moment.before, world);
  world_to_local(clip.skeleton.parents, world, first);
  clip.get_pose(moment.before + 1, world);
  world_to_local(clip.skeleton.parents, world, second);
  for (std::size_t j = 0; j < joints; ++j) {
    first[j].position += moment.fraction * (second[j].position - first[j].position);
    first[j].orientation = slerp(first[j].orientation, second[j].orientation, moment.fraction);
  }
  local_to_world(clip.skeleton.parents, first, joint_to_world);
}

}  // namespace

void sample(const Clip& clip, double time, std::span<Transform> joint_to_world,
            std::span<Transform> scratch) {
  if (clip.frame_count() == 0) {
    std::copy(clip.skeleton.reference.begin(), clip.skeleton.reference.end(),
              joint_to_world.begin());
    return;
  }
  const FrameMoment moment = frame_moment(time, clip.rate, clip.frame_count());
  if (moment.fraction == 0) {
    clip.get_pose(moment.before, joint_to_world);
  } else {
    sample_between(clip, moment, joint_to_world, scratch);
  }
}

Result<Clip> resample(const Clip& clip, double rate) {
  const auto made = resample(frames_of(clip), rate);
  if (!made) return made.error();
  auto result = load(*made, 1);
  if (result) result->provenance = clip.provenance;
  return result;
}

Result<FrameSource> resample(const FrameSource& source, double rate) {
  const auto frames = frames_within(source.duration(), rate, source.joint_count());
  if (!frames) return frames.error();
  FrameSource result = source;
  result.rate = rate;
  result.frame_count = source.frame_count == 0 ? 0 : *frames;
  const auto moment = [rate, from = source.rate, count = source.frame_count](int frame) {
    return frame_moment(frame / rate, from, count);
  };
  if (source.release) {
    result.release = [moment, release = source.release](int frame) {
      release(moment(frame).before);
    };
  }
  result.read = [source, moment](int first, int count, std::span<Vec3f> positions,
                                 std::span<Quatf> orientations) -> Status {
    const auto joints = static_cast<std::size_t>(source.joint_count());
    std::vector<Transform> pose(joints), scratch(3 * joints);
    constexpr int kMaxSpan = 1024;  // frames of the source that are read together
    Clip made, span;
    made.skeleton = source.skeleton;
    made.resize(count);
    for (int f = 0, begin = 0, end = 0; f < count; ++f) {
      FrameMoment at = moment(first + f);
      if (const int needed = at.before + (at.fraction > 0 ? 2 : 1); needed > end) {
        begin = at.before;
        end = std::max(needed, std::min(moment(first + count - 1).before + 2, begin + kMaxSpan));
        end = std::min(end, source.frame_count);
        auto loaded = load(part_of(source, begin, end - begin), 1);
        if (!loaded) return loaded.error();
        span = *std::move(loaded);
      }
      at.before -= begin;
      if (at.fraction == 0) {
        std::ranges::copy(span.frame_positions(at.before), made.frame_positions(f).begin());
        std::ranges::copy(span.frame_orientations(at.before), made.frame_orientations(f).begin());
      } else {
        sample_between(span, at, pose, scratch);
        made.set_pose(f, pose);
      }
    }
    std::ranges::copy(made.positions, positions.begin());
    std::ranges::copy(made.orientations, orientations.begin());
    return {};
  };
  return result;
}

Result<Clip> retime(const Clip& clip, double rate, double speed, LastFrame last) {
  const auto made = retime(frames_of(clip), rate, speed, last);
  if (!made) return made.error();
  auto result = load(*made, 1);
  if (result) result->provenance = clip.provenance;
  return result;
}

Result<FrameSource> retime(const FrameSource& source, double rate, double speed, LastFrame last) {
  if (!(speed > 0) || !std::isfinite(speed)) {
    return Error("motion-speed", fmt::format("invalid speed {}", speed),
                 "the speed must be a positive number; 2 is twice as fast");
  }
  // Raising the rate speeds the frames up; resampling then restores the requested rate.
  FrameSource faster = source;
  faster.rate = source.rate * speed;
  if (!std::isfinite(faster.rate) || !(faster.rate > 0)) {
    return Error("motion-speed", fmt::format("a speed of {} is out of range", speed));
  }
  const double steps = faster.duration() * rate;
  if (last == LastFrame::kept && steps > 0 && steps < 1e9 && std::isfinite(rate)) {
    // Adjusts the speed so that a whole number of frames spans the motion.
    const double whole = std::max(1.0, std::round(steps));
    faster.rate = (source.frame_count - 1) * rate / whole;
  }
  return resample(faster, rate);
}

Result<Clip> retime_on_curves(const Clip& clip, double rate, double speed, double tension,
                              bool keep_last) {
  if (!(speed > 0) || !std::isfinite(speed) || !(tension >= 0 && tension <= 1)) {
    return Error("motion-speed", "the speed must be positive, the tension from 0 to 1");
  }
  double end = clip.duration() / speed;
  if (keep_last && end > 0) end = std::max(1.0, std::round(end * rate)) / rate;
  const auto count = frames_within(end, rate, clip.joint_count());
  if (!count) return count.error();
  Clip result;
  result.skeleton = clip.skeleton;
  result.provenance = clip.provenance;
  result.rate = rate;
  const std::size_t joints = clip.skeleton.names.size(), frames = at(clip.frame_count());
  if (joints == 0 || frames == 0) return result;
  // The keys of all joints, one a frame.
  struct Joint {
    std::vector<Vec3> positions, velocities;
    std::vector<Quat> rotations;
    std::vector<Vec3> spins;
  };
  std::vector<Joint> keys(joints);
  std::vector<double> times;
  std::vector<Transform> world(joints), local(joints);
  const double scale = clip.duration() > 0 ? end / clip.duration() : 1;
  for (std::size_t f = 0; f < frames; ++f) {
    clip.get_pose(static_cast<int>(f), world);
    world_to_local(clip.skeleton.parents, world, local);
    // The last time is the duration's, however f / rate is rounded.
    const double time = f + 1 == frames ? clip.duration() : static_cast<double>(f) / clip.rate;
    times.push_back(std::min(time * scale, end));
    for (std::size_t j = 0; j < joints; ++j) {
      Joint& joint = keys[j];
      const Quat before = f == 0 ? local[j].orientation : joint.rotations.back();
      joint.positions.push_back(local[j].position);
      joint.rotations.push_back(in_hemisphere_of(before, local[j].orientation));
    }
  }
  for (Joint& joint : keys) {
    joint.velocities.resize(frames);
    joint.spins.resize(frames);
    tension_velocities(times, joint.positions, tension, Ends::open, joint.velocities);
    squad_velocities(times, joint.rotations, tension, Ends::open, joint.spins);
  }
  result.resize(*count);
  std::vector<Mat4> matrices(joints);
  std::size_t k = 0;
  for (int f = 0; f < result.frame_count(); ++f) {
    const double time = std::min(f / rate, end);
    k = key_before(times, time, k);
    const double span = k + 1 < frames ? times[k + 1] - times[k] : 1;
    const double part = k + 1 < frames ? (time - times[k]) / span : 0;
    for (std::size_t j = 0; j < joints; ++j) {
      const Joint& of = keys[j];
      Transform joint{of.positions[k], of.rotations[k]};
      if (part != 0) {
        joint = {
            hermite(of.positions[k], of.velocities[k], of.positions[k + 1], of.velocities[k + 1],
                    span, part),
            squad(of.rotations[k], of.spins[k], of.rotations[k + 1], of.spins[k + 1], span, part)};
      }
      const int parent = clip.skeleton.parents[j];
      matrices[j] = parent < 0 ? joint.matrix() : Mat4(matrices[at(parent)] * joint.matrix());
      world[j] = {
          matrices[j].topRightCorner<3, 1>(),
          parent < 0 ? joint.orientation : world[at(parent)].orientation * joint.orientation};
    }
    for (Transform& joint : world) joint.orientation = normalized_or_identity(joint.orientation);
    result.set_pose(f, world);
  }
  return result;
}

Clip cut(const Clip& clip, int first, int last, int step) {
  assert(0 <= first && first <= last && last < clip.frame_count() && step >= 1);
  Clip result;
  result.skeleton = clip.skeleton;
  result.provenance = clip.provenance;
  result.rate = clip.rate / step;
  result.resize((last - first) / step + 1);
  for (int f = 0; f < result.frame_count(); ++f) {
    const int from = first + f * step;
    std::ranges::copy(clip.frame_positions(from), result.frame_positions(f).begin());
    std::ranges::copy(clip.frame_orientations(from), result.frame_orientations(f).begin());
  }
  return result;
}

}  // namespace krok
