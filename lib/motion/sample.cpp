#include "motion/sample.h"

#include <algorithm>

#include "math/quaternion.h"
#include "scene/frame_blocks.h"
#include "scene/frame_moment.h"

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

}  // namespace krok
