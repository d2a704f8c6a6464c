#include "compare/clip_difference.h"

#include <fmt/format.h>

#include <algorithm>

#include "compare/frame_match.h"
#include "compare/skeleton_match.h"
#include "core/numbers.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

Error of_which(Error error, const char* which) {
  error.message = fmt::format("{}: {}", which, error.message);
  return error;
}

void compare_references(const Skeleton& first, const Skeleton& second, const Pairs& joints,
                        ClipDifference& result) {
  for (const auto& [i, j] : joints) {
    const Transform& a = first.reference[static_cast<std::size_t>(i)];
    const Transform& b = second.reference[static_cast<std::size_t>(j)];
    const ValueLocation place{.joint = i};
    result.reference_positions.add((a.position - b.position).norm(), place);
    result.reference_orientations.add(angle_between(a.orientation, b.orientation), place);
  }
}

// A reference pose that is only elsewhere counts, but comes of a format that does not have its
// place.
void note_shifted_reference(const Skeleton& first, const Skeleton& second, const Pairs& joints,
                            const Tolerance& tolerance, ClipDifference& result) {
  if (result.reference_positions.within()) return;
  const auto shift = [&](const std::pair<int, int>& pair) -> Vec3 {
    return second.reference[static_cast<std::size_t>(pair.second)].position -
           first.reference[static_cast<std::size_t>(pair.first)].position;
  };
  const Vec3 way = shift(joints.front());
  const bool all = std::ranges::all_of(joints, [&](const auto& pair) {
    return (shift(pair) - way).norm() <= tolerance.of_joint_positions();
  });
  if (!all) return;
  result.notes.push_back(fmt::format(
      "the reference pose is the same but for its place, ({}, {}, {}) mm away, which does not show "
      "in the motion; BVH keeps it with krok-export --root-offset",
      readable(1000 * way.x(), 4), readable(1000 * way.y(), 4), readable(1000 * way.z(), 4)));
}

void compare_frames(const Clip& first, const Clip& second, const Pairs& joints,
                    const FrameMatch& frames, ClipDifference& result) {
  for (const auto& pair : joints) {
    result.joints.push_back({pair.first, result.positions, result.orientations});
  }
  std::vector<Transform> a(static_cast<std::size_t>(first.joint_count()));
  std::vector<Transform> b(static_cast<std::size_t>(second.joint_count()));
  for (const auto& [frame_a, frame_b] : frames.frames) {
    first.get_pose(frame_a, a);
    second.get_pose(frame_b, b);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const Transform& one = a[static_cast<std::size_t>(joints[k].first)];
      const Transform& other = b[static_cast<std::size_t>(joints[k].second)];
      const ValueLocation place{
          .joint = joints[k].first, .frame = frame_a, .time = frame_a / first.rate};
      const double distance = (one.position - other.position).norm();
      const double angle = angle_between(one.orientation, other.orientation);
      result.positions.add(distance, place);
      result.orientations.add(angle, place);
      result.joints[k].positions.add(distance, place);
      result.joints[k].orientations.add(angle, place);
    }
  }
}

void compare_stretches(const Clip& first, const Clip& second, std::span<const Stretch> a,
                       std::span<const Stretch> b, const Pairs& joints, const FrameMatch& frames,
                       ClipDifference& result) {
  if (a.empty() && b.empty()) return;
  const auto of = [](const Clip& clip, std::span<const Stretch> all, int frame, int joint) {
    if (all.empty()) return Stretch();
    return all[static_cast<std::size_t>(frame) * static_cast<std::size_t>(clip.joint_count()) +
               static_cast<std::size_t>(joint)];
  };
  for (const auto& [frame_a, frame_b] : frames.frames) {
    for (const auto& [joint_a, joint_b] : joints) {
      const Stretch one = of(first, a, frame_a, joint_a), other = of(second, b, frame_b, joint_b);
      if (one == Stretch() && other == Stretch()) continue;
      result.stretches.add((one.matrix() - other.matrix()).norm(),
                           {.joint = joint_a, .frame = frame_a, .time = frame_a / first.rate});
    }
  }
}

}  // namespace

Result<ClipDifference> difference(const Clip& first, const Clip& second, const Tolerance& tolerance,
                                  Matching matching, std::span<const Stretch> first_stretches,
                                  std::span<const Stretch> second_stretches) {
  if (auto ok = check(first); !ok) return of_which(ok.error(), "the first clip");
  if (auto ok = check(second); !ok) return of_which(ok.error(), "the second clip");
  if (auto ok = check(first_stretches, first); !ok) return of_which(ok.error(), "the first clip");
  if (auto ok = check(second_stretches, second); !ok) {
    return of_which(ok.error(), "the second clip");
  }

  ClipDifference result;
  result.reference_positions = result.positions = Measure(tolerance.of_joint_positions());
  result.reference_orientations = result.orientations = Measure(tolerance.of_joint_orientations());

  const SkeletonMatch skeletons = match_skeletons(first.skeleton, second.skeleton, matching);
  if (!skeletons.difference.empty()) result.structure.push_back(skeletons.difference);
  Pairs joints;
  for (std::size_t j = 0; j < skeletons.second_of_first.size(); ++j) {
    const int other = skeletons.second_of_first[j];
    if (other >= 0) joints.emplace_back(static_cast<int>(j), other);
  }
  if (joints.empty()) return result;
  compare_references(first.skeleton, second.skeleton, joints, result);
  note_shifted_reference(first.skeleton, second.skeleton, joints, tolerance, result);

  FrameMatch frames = match_frames(first.frame_count(), first.rate, second.frame_count(),
                                   second.rate, tolerance.time);
  result.structure.insert(result.structure.end(), frames.differences.begin(),
                          frames.differences.end());
  result.compared_frames = static_cast<int>(frames.frames.size());
  compare_frames(first, second, joints, frames, result);
  result.stretches = Measure(tolerance.ratio);
  compare_stretches(first, second, first_stretches, second_stretches, joints, frames, result);
  return result;
}

}  // namespace krok::compare
