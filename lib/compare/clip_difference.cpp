#include "compare/clip_difference.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "core/parallel.h"
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

// Consecutive frames of one motion.
struct Frames {
  int first = 0;
  std::vector<Vec3f> positions;
  std::vector<Quatf> orientations;

  Status read(const FrameSource& source, int from, int to) {
    const auto count = static_cast<std::size_t>(to - from + 1);
    const auto joints = static_cast<std::size_t>(source.joint_count());
    first = from;
    positions.resize(count * joints);
    orientations.resize(count * joints);
    return source.read(from, to - from + 1, positions, orientations);
  }
  // As Clip::get_pose() has it.
  Transform at(const FrameSource& source, int frame, int joint) const {
    const auto i =
        static_cast<std::size_t>(frame - first) * static_cast<std::size_t>(source.joint_count()) +
        static_cast<std::size_t>(joint);
    return {positions[i].cast<double>(), normalized_or_identity(orientations[i].cast<double>())};
  }
};

Status compare_frames(const FrameSource& first, const FrameSource& second, const Pairs& joints,
                      const FrameMatch& matched, int jobs, ClipDifference& result) {
  for (const auto& pair : joints) {
    result.joints.push_back({pair.first, result.positions, result.orientations});
  }
  const auto& frames = matched.frames;
  if (frames.empty()) return {};
  // Fewer where frames are skipped.
  constexpr std::size_t kPairsAtOnce = 128;
  const auto longer = static_cast<std::size_t>(std::max(first.frame_count, second.frame_count));
  const std::size_t at_once =
      std::clamp<std::size_t>(kPairsAtOnce * frames.size() / longer, 1, kPairsAtOnce);
  struct Block {
    Frames first, second;
    std::vector<std::pair<double, double>> differences;  // of positions, of orientations
  };
  std::vector<Block> blocks(slots_for(jobs));
  const auto pairs_of = [&](std::size_t item) {
    return std::span(frames).subspan(item * at_once,
                                     std::min(at_once, frames.size() - item * at_once));
  };
  const auto make = [&](std::size_t item, std::size_t slot) -> Status {
    Block& block = blocks[slot];
    const auto pairs = pairs_of(item);
    const auto& [a, b] = pairs.front();
    const auto& [last_a, last_b] = pairs.back();
    if (Status status = block.first.read(first, a, last_a); !status) return status;
    if (Status status = block.second.read(second, b, last_b); !status) return status;
    block.differences.clear();
    for (const auto& [frame_a, frame_b] : pairs) {
      for (const auto& [joint_a, joint_b] : joints) {
        const Transform one = block.first.at(first, frame_a, joint_a);
        const Transform other = block.second.at(second, frame_b, joint_b);
        block.differences.emplace_back((one.position - other.position).norm(),
                                       angle_between(one.orientation, other.orientation));
      }
    }
    return {};
  };
  const auto take = [&](std::size_t item, std::size_t slot) {
    const auto pairs = pairs_of(item);
    auto differs = blocks[slot].differences.begin();
    for (const auto& [frame_a, frame_b] : pairs) {
      for (std::size_t k = 0; k < joints.size(); ++k) {
        const auto [distance, angle] = *differs++;
        const ValueLocation place{
            .joint = joints[k].first, .frame = frame_a, .time = frame_a / first.rate};
        result.positions.add(distance, place);
        result.orientations.add(angle, place);
        result.joints[k].positions.add(distance, place);
        result.joints[k].orientations.add(angle, place);
      }
    }
    if (first.release) first.release(pairs.back().first + 1);
    if (second.release) second.release(pairs.back().second + 1);
    return Status();
  };
  return make_in_order((frames.size() + at_once - 1) / at_once, jobs, make, take);
}

void compare_stretches(const FrameSource& first, const FrameSource& second,
                       std::span<const Stretch> a, std::span<const Stretch> b, const Pairs& joints,
                       const FrameMatch& frames, ClipDifference& result) {
  if (a.empty() && b.empty()) return;
  const auto of = [](const FrameSource& clip, std::span<const Stretch> all, int frame, int joint) {
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

  return difference(frames_of(first), frames_of(second), tolerance, matching, first_stretches,
                    second_stretches);
}

Result<ClipDifference> difference(const FrameSource& first, const FrameSource& second,
                                  const Tolerance& tolerance, Matching matching,
                                  std::span<const Stretch> first_stretches,
                                  std::span<const Stretch> second_stretches, int jobs) {
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

  FrameMatch frames =
      match_frames(first.frame_count, first.rate, second.frame_count, second.rate, tolerance.time);
  result.structure.insert(result.structure.end(), frames.differences.begin(),
                          frames.differences.end());
  result.compared_frames = static_cast<int>(frames.frames.size());
  Status compared = compare_frames(first, second, joints, frames, jobs, result);
  if (!compared) return compared.error();
  result.stretches = Measure(tolerance.ratio);
  compare_stretches(first, second, first_stretches, second_stretches, joints, frames, result);
  return result;
}

}  // namespace krok::compare
