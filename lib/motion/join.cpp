#include "motion/join.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "math/hermite.h"
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

// About the time of two steps, over which the turns of hips and chest add up to nothing.
constexpr double kTwoSteps = 1.2;  // seconds
// Radians: from the first to the second half of that time, and between joints of two poses.
constexpr double kStraight = 8 * kRadiansPerDegree, kTurning = 20 * kRadiansPerDegree;
constexpr double kAlike = 3 * kRadiansPerDegree, kOther = 12 * kRadiansPerDegree;
constexpr double kTwistedChest = 60 * kRadiansPerDegree;

// The joints that tell how a character faces.
struct Facing {
  int carrier = 0, chest = -1;
  double twist = 0;  // of the chest against the hips in the reference pose, radians

  // Reference poses that are twisted between hips and chest have motions turned by far more there
  // than people can be.
  Facing(const Clip& clip, int hips, int upper) : carrier(hips), chest(upper) {
    if (chest < 0) return;
    Vec2 sum = Vec2::Zero();
    for (int f = 0; f < clip.frame_count(); ++f) {
      const double apart =
          ground_frame(clip, chest, f).heading - ground_frame(clip, carrier, f).heading;
      sum += Vec2(std::cos(apart), std::sin(apart));
    }
    const double mean = std::atan2(sum.y(), sum.x());
    if (std::abs(mean) > kTwistedChest) twist = mean;
  }

  // Between hips and chest.
  double operator()(const Clip& clip, int frame) const {
    const double hips = ground_frame(clip, carrier, frame).heading;
    if (chest < 0) return hips;
    return hips + 0.5 * wrapped(ground_frame(clip, chest, frame).heading - hips - twist);
  }
};

// Likewise, over the time up to `frame` or, with `step` 1, from there on, as far as the motion
// goes.
double steady_facing(const Clip& clip, const Facing& facing, int frame, int step) {
  const int ahead = step > 0 ? clip.frame_count() - 1 - frame : frame;
  const int count = 1 + std::min(ahead, static_cast<int>(std::lround(kTwoSteps * clip.rate)));
  const double here = facing(clip, frame);
  double turn = 0;  // from `here`
  std::array<double, 2> halves = {0, 0};
  for (int k = 0; k < count; ++k) {
    turn += wrapped(facing(clip, frame + step * k) - here - turn);
    halves[2 * k < count ? 0 : 1] += turn;
  }
  const int near = (count + 1) / 2;
  const double mean = (halves[0] + halves[1]) / count;
  const double change = count > near ? halves[1] / (count - near) - halves[0] / near : 0;
  const double turns = smoother_step((std::abs(change) - kStraight) / (kTurning - kStraight));
  return here + (1 - turns) * mean;
}

double largest_difference(const Clip& first, int first_frame, const Clip& second,
                          int second_frame) {
  double largest = 0;
  const auto a = first.frame_orientations(first_frame), b = second.frame_orientations(second_frame);
  for (std::size_t j = 1; j < a.size(); ++j) {
    const std::size_t parent = at(first.skeleton.parents[j]);
    largest = std::max<double>(
        largest, (a[parent].conjugate() * a[j]).angularDistance(b[parent].conjugate() * b[j]));
  }
  return largest;
}

// Maps the character's ground frame in the second motion to that in the first.
Transform alignment(const Clip& first, int first_frame, const Clip& second, int second_frame,
                    int carrier, const JoinOptions& options) {
  GroundFrame end = ground_frame(first, carrier, first_frame);
  GroundFrame start = ground_frame(second, carrier, second_frame);
  const double other = smoother_step(
      (largest_difference(first, first_frame, second, second_frame) - kAlike) / (kOther - kAlike));
  const Facing facing(first, carrier, options.chest);
  end.heading += other * wrapped(steady_facing(first, facing, first_frame, -1) - end.heading);
  start.heading += other * wrapped(steady_facing(second, facing, second_frame, 1) - start.heading);
  Transform move = end.to_world() * start.to_world().inverse();
  if (options.match_height) {
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
  move_clip(alignment(first, begin + middle, next, middle, carrier, options), next);

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
