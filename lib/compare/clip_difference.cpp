#include "compare/clip_difference.h"

#include <fmt/format.h>

#include "compare/frame_match.h"
#include "compare/skeleton_match.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

Error of_which(Error error, const char* which) {
  error.message = fmt::format("{}: {}", which, error.message);
  return error;
}

}  // namespace

Result<ClipDifference> difference(const Clip& first, const Clip& second,
                                  const Tolerance& tolerance) {
  if (auto ok = check(first); !ok) return of_which(ok.error(), "the first clip");
  if (auto ok = check(second); !ok) return of_which(ok.error(), "the second clip");

  ClipDifference result;
  result.reference_positions = result.positions = Measure(tolerance.length);
  result.reference_orientations = result.orientations = Measure(tolerance.angle);

  SkeletonMatch skeletons = match_skeletons(first.skeleton, second.skeleton);
  if (!skeletons.difference.empty()) {
    result.structure.push_back(std::move(skeletons.difference));
    return result;
  }
  const auto joints = static_cast<std::size_t>(first.joint_count());
  const auto& second_of_first = skeletons.second_of_first;
  for (std::size_t j = 0; j < joints; ++j) {
    const Transform& a = first.skeleton.reference[j];
    const Transform& b = second.skeleton.reference[static_cast<std::size_t>(second_of_first[j])];
    const Place place{.joint = static_cast<int>(j)};
    result.reference_positions.add((a.position - b.position).norm(), place);
    result.reference_orientations.add(angle_between(a.orientation, b.orientation), place);
  }

  FrameMatch frames =
      match_frames(first.frame_count(), first.rate, second.frame_count(), second.rate);
  result.structure = std::move(frames.differences);
  result.compared_frames = static_cast<int>(frames.frames.size());

  std::vector<Transform> a(joints), b(joints);
  for (const auto& [frame_a, frame_b] : frames.frames) {
    first.get_pose(frame_a, a);
    second.get_pose(frame_b, b);
    for (std::size_t j = 0; j < joints; ++j) {
      const Transform& other = b[static_cast<std::size_t>(second_of_first[j])];
      const Place place{
          .joint = static_cast<int>(j), .frame = frame_a, .time = frame_a / first.rate};
      result.positions.add((a[j].position - other.position).norm(), place);
      result.orientations.add(angle_between(a[j].orientation, other.orientation), place);
    }
  }
  return result;
}

}  // namespace krok::compare
