#include "motion/join.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "math/quaternion.h"
#include "motion/ground_frame.h"
#include "motion/hips_root.h"
#include "motion/local_motion.h"
#include "motion/place.h"
#include "motion/sample.h"

namespace krok {

namespace {

constexpr const char* kRetarget = "retarget it to the same skeleton with krok-retarget";

// The joints above the hips only place the character, so their offsets and the hips' are not
// compared.
Status same_skeleton(const Skeleton& first, const Skeleton& second, int carrier) {
  const std::string difference = difference_in_structure(first, second);
  if (!difference.empty()) {
    return Error("motion-skeleton", "the skeletons differ: " + difference, kRetarget);
  }
  const double allowed = 0.01 * std::max(reference_extent(first), reference_extent(second));
  for (int j = 1; j < first.joint_count(); ++j) {
    if (subtree(first, j)[at(carrier)] != 0) continue;
    const Vec3 a = first.reference_local(j).position;
    const Vec3 b = second.reference_local(j).position;
    if ((a - b).norm() <= allowed) continue;
    const std::string& name = first.names[static_cast<std::size_t>(j)];
    const bool length = std::abs(a.norm() - b.norm()) > allowed;
    Error error(
        "motion-skeleton",
        length
            ? fmt::format("the bone to {} is {} m long in the first motion and {} m in the second",
                          name, readable(a.norm(), 4), readable(b.norm(), 4))
            : fmt::format("{} has another offset from its parent in the second motion: the "
                          "reference poses differ",
                          name),
        kRetarget);
    error.joint = name;
    return error;
  }
  return {};
}

// Maps the character's ground frame in the second motion to that in the first.
Transform alignment(const Clip& first, int first_frame, const Clip& second, int second_frame,
                    int carrier, bool match_height) {
  Transform move = ground_frame(first, carrier, first_frame).to_world() *
                   ground_frame(second, carrier, second_frame).to_world().inverse();
  if (match_height) {
    const auto c = static_cast<std::size_t>(carrier);
    move.position.y() = static_cast<double>(first.frame_positions(first_frame)[c].y()) -
                        second.frame_positions(second_frame)[c].y();
  }
  return move;
}

// Joins motions rooted at the hips.
Result<Joined> join_rooted(const Clip& first, const Clip& second, int carrier,
                           const JoinOptions& options) {
  if (first.frame_count() == 0) {
    Joined all{second};
    all.clip.skeleton = first.skeleton;
    all.clip.provenance = first.provenance;
    return all;
  }
  if (second.frame_count() == 0) return Joined{first, first.frame_count() - 1};
  auto resampled = resample(second, first.rate);
  if (!resampled) return resampled.error();
  Clip& next = *resampled;
  const int n = first.frame_count(), m = next.frame_count();
  const double wanted = std::round(options.blend * first.rate);
  if (wanted > std::min(n, m) - 1) {
    return Error("motion-blend",
                 fmt::format("motions of {} s and {} s are too short for a blend of {} s",
                             readable(first.duration(), 4), readable(next.duration(), 4),
                             readable(options.blend, 4)),
                 "use a shorter --blend");
  }
  const int shared = static_cast<int>(wanted);
  const int begin = n - 1 - shared;  // the first's frame at which the second begins
  const int middle = shared / 2;
  move_clip(alignment(first, begin + middle, next, middle, carrier, options.match_height), next);

  const LocalMotion a = local_motion(first), b = local_motion(next);
  LocalMotion whole;
  whole.joints = a.joints;
  whole.frames = begin + m;
  whole.orientations.resize(static_cast<std::size_t>(whole.joints) *
                            static_cast<std::size_t>(whole.frames));
  whole.positions.resize(whole.orientations.size());
  Joined result;
  result.joint_frame = begin + middle;
  result.shared_frames = shared + 1;
  for (int j = 0; j < whole.joints; ++j) {
    for (int f = 0; f < whole.frames; ++f) {
      const int k = f - begin;
      if (k <= 0 || f >= n) {
        whole.set(j, f, k <= 0 ? a.at(j, f) : b.at(j, k));
        continue;
      }
      const double u = static_cast<double>(k) / shared;
      const double weight = u * u * (3 - 2 * u);
      const Transform from = a.at(j, f), to = b.at(j, k);
      whole.set(j, f,
                {from.position + weight * (to.position - from.position),
                 slerp(from.orientation, to.orientation, weight)});
    }
    const double angle =
        angle_between(a.at(j, result.joint_frame).orientation, b.at(j, middle).orientation);
    if (angle > result.largest_angle) {
      result.largest_angle = angle;
      result.largest_joint = j;
    }
  }
  result.clip.skeleton = first.skeleton;
  result.clip.rate = first.rate;
  result.clip.provenance = first.provenance;
  set_local_motion(whole, result.clip);
  return result;
}

}  // namespace

Result<Joined> join(const Clip& first, const Clip& second, int carrier,
                    const JoinOptions& options) {
  if (Status status = same_skeleton(first.skeleton, second.skeleton, carrier); !status)
    return status.error();
  if (!(options.blend >= 0) || !std::isfinite(options.blend)) {
    return Error("motion-blend", "the time that two motions share is 0 or more");
  }
  const HipsRoot hips_root(std::array<const Clip*, 2>{&first, &second}, carrier);
  if (!hips_root.changes()) return join_rooted(first, second, carrier, options);
  auto joined = join_rooted(hips_root.rooted(first), hips_root.rooted(second), carrier, options);
  if (!joined) return joined;
  joined->clip = hips_root.restored(joined->clip, first.skeleton);
  joined->largest_joint = hips_root.original(joined->largest_joint);
  return joined;
}

}  // namespace krok
