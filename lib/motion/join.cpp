#include "motion/join.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/index.h"
#include "core/numbers.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/sample.h"
#include "motion/travel.h"

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
  static Result<Facing> of(const FrameSource& motion, int hips, int upper, int jobs) {
    Facing facing{hips, upper};
    if (upper < 0) return facing;
    Vec2 sum = Vec2::Zero();
    const Status status = for_each_block(motion, jobs, [&](int, const Clip& block) {
      for (int f = 0; f < block.frame_count(); ++f) {
        const double apart =
            ground_frame(block, upper, f).heading - ground_frame(block, hips, f).heading;
        sum += Vec2(std::cos(apart), std::sin(apart));
      }
      return Status();
    });
    if (!status) return status.error();
    const double mean = std::atan2(sum.y(), sum.x());
    if (std::abs(mean) > kTwistedChest) facing.twist = mean;
    return facing;
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
                    const Facing& facing, bool match_height) {
  const int carrier = facing.carrier;
  GroundFrame end = ground_frame(first, carrier, first_frame);
  GroundFrame start = ground_frame(second, carrier, second_frame);
  const double other = smoother_step(
      (largest_difference(first, first_frame, second, second_frame) - kAlike) / (kOther - kAlike));
  end.heading += other * wrapped(steady_facing(first, facing, first_frame, -1) - end.heading);
  start.heading += other * wrapped(steady_facing(second, facing, second_frame, 1) - start.heading);
  Transform move = end.to_world() * start.to_world().inverse();
  if (match_height) {
    const auto c = static_cast<std::size_t>(carrier);
    move.position.y() = static_cast<double>(first.frame_positions(first_frame)[c].y()) -
                        second.frame_positions(second_frame)[c].y();
  }
  return move;
}

// A motion moved in the world; its reference pose is unchanged.
FrameSource moved(const FrameSource& motion, const Transform& move) {
  return changed(motion, [move](Clip& frames) {
    move_clip(move, frames);
    return Status();
  });
}

// The frames of `first` up to the overlap, those of the overlap, and those of `second` after it.
class Joint {
 public:
  Joint(FrameSource first, FrameSource second, int shared)
      : first_(std::move(first)), second_(std::move(second)), shared_(shared) {}

  // The first's frame at which the second begins.
  int begin() const { return first_.frame_count - 1 - shared_; }

  Status read(int from, int count, std::span<Vec3f> positions,
              std::span<Quatf> orientations) const {
    Clip made{first_.skeleton, first_.rate, {}, {}, {}};
    made.resize(count);
    const int end = from + count;
    const auto a = part(first_, from, std::min(end, first_.frame_count));
    if (!a) return a.error();
    const int second_from = std::max(from - begin(), 0);
    const auto b = part(second_, second_from, end - begin());
    if (!b) return b.error();
    std::vector<Transform> pose(made.skeleton.names.size()), scratch(pose), other(pose);
    for (int f = from; f < end; ++f) {
      const int k = f - begin();
      const bool after = k > 0 && f >= first_.frame_count;
      local_pose(after ? *b : *a, after ? k - second_from : f - from, scratch, pose);
      if (k > 0 && !after) {
        const double u = static_cast<double>(k) / shared_;
        const double weight = u * u * (3 - 2 * u);
        local_pose(*b, k - second_from, scratch, other);
        for (std::size_t j = 0; j < pose.size(); ++j) {
          pose[j].position += weight * (other[j].position - pose[j].position);
          pose[j].orientation = slerp(pose[j].orientation, other[j].orientation, weight);
        }
      }
      local_to_world(made.skeleton.parents, pose, pose);
      for (Transform& joint : pose) joint.orientation = normalized_or_identity(joint.orientation);
      made.set_pose(f - from, pose);
    }
    std::ranges::copy(made.positions, positions.begin());
    std::ranges::copy(made.orientations, orientations.begin());
    return {};
  }

  void release(int frame) const {
    if (first_.release) first_.release(std::min(frame, first_.frame_count));
    if (second_.release && frame > begin()) second_.release(frame - begin());
  }

  // By how much rotations differ in the middle of the overlap.
  Status measure(JoinSeam& seam) const {
    const int middle = shared_ / 2;
    seam.joint_frame = begin() + middle;
    seam.shared_frames = shared_ + 1;
    const auto a = part(first_, seam.joint_frame, seam.joint_frame + 1);
    if (!a) return a.error();
    const auto b = part(second_, middle, middle + 1);
    if (!b) return b.error();
    std::vector<Transform> scratch(first_.skeleton.names.size()), from(scratch), to(scratch);
    local_pose(*a, 0, scratch, from);
    local_pose(*b, 0, scratch, to);
    for (std::size_t j = 0; j < from.size(); ++j) {
      const double angle = angle_between(from[j].orientation, to[j].orientation);
      if (angle <= seam.largest_angle) continue;
      seam.largest_angle = angle;
      seam.largest_joint = static_cast<int>(j);
    }
    return {};
  }

 private:
  // Frames [from, end); none if there are none.
  static Result<Clip> part(const FrameSource& motion, int from, int end) {
    return load(part_of(motion, from, std::max(end - from, 0)), 1);
  }
  static void local_pose(const Clip& clip, int frame, std::span<Transform> scratch,
                         std::span<Transform> local) {
    clip.get_pose(frame, scratch);
    world_to_local(clip.skeleton.parents, scratch, local);
  }

  FrameSource first_, second_;
  int shared_;
};

// Joins motions rooted at the hips.
Result<JoinedFrames> join_rooted(const FrameSource& first, const FrameSource& second, int carrier,
                                 const JoinOptions& options, int jobs) {
  if (first.frame_count == 0) {
    JoinedFrames all{{}, second};
    all.frames.skeleton = first.skeleton;
    return all;
  }
  if (second.frame_count == 0) return JoinedFrames{{first.frame_count - 1}, first};
  const auto resampled = resample(second, first.rate);
  if (!resampled) return resampled.error();
  const FrameSource& next = *resampled;
  const int n = first.frame_count, m = next.frame_count;
  const double wanted = std::round(options.blend * first.rate);
  if (wanted > std::min(n, m) - 1) {
    return Error("motion-blend",
                 fmt::format("motions of {} s and {} s are too short for a blend of {} s",
                             readable(first.duration(), 4), readable(next.duration(), 4),
                             readable(options.blend, 4)),
                 "use a shorter --blend");
  }
  const int shared = static_cast<int>(wanted), middle = shared / 2;
  const auto facing = Facing::of(first, carrier, options.chest, jobs);
  if (!facing) return facing.error();
  // The frames that steady_facing() looks at.
  const int looked_at = shared + 1 + static_cast<int>(std::lround(kTwoSteps * first.rate));
  const auto end = load(part_of(first, std::max(n - looked_at, 0), std::min(n, looked_at)), jobs);
  if (!end) return end.error();
  const auto start = load(part_of(next, 0, std::min(m, looked_at)), jobs);
  if (!start) return start.error();
  const int joint_frame = end->frame_count() - 1 - shared + middle;
  const Transform move =
      alignment(*end, joint_frame, *start, middle, *facing, options.match_height);

  const auto joint = std::make_shared<const Joint>(first, moved(next, move), shared);
  JoinedFrames joined;
  if (Status status = joint->measure(joined); !status) return status.error();
  joined.frames = first;
  joined.frames.frame_count = joint->begin() + m;
  joined.frames.read = [joint](auto... block) { return joint->read(block...); };
  joined.frames.release = [joint](int frame) { joint->release(frame); };
  return joined;
}

}  // namespace

Result<Joined> join(const Clip& first, const Clip& second, int carrier,
                    const JoinOptions& options) {
  const auto joined = join(frames_of(first), frames_of(second), carrier, options, 1);
  if (!joined) return joined.error();
  auto clip = load(joined->frames, 1);
  if (!clip) return clip.error();
  clip->provenance = first.provenance;
  return Joined{*joined, *std::move(clip)};
}

Result<JoinedFrames> join(const FrameSource& first, const FrameSource& second, int carrier,
                          const JoinOptions& options, int jobs) {
  if (Status status = same_skeleton(first.skeleton, second.skeleton, carrier); !status) {
    return status.error();
  }
  if (!(options.blend >= 0) || !std::isfinite(options.blend)) {
    return Error("motion-blend", "the time that two motions share is 0 or more");
  }
  const auto found = HipsRoot::of(std::array{first, second}, carrier, jobs);
  if (!found) return found.error();
  const HipsRoot hips_root = *found;
  if (!hips_root.changes()) return join_rooted(first, second, carrier, options, jobs);
  const auto rooted = [&](const FrameSource& motion) {
    FrameSource result = changed(motion, [hips_root](Clip& frames) {
      frames = hips_root.rooted(frames);
      return Status();
    });
    result.skeleton = hips_root.rooted(motion.skeleton);
    return result;
  };
  auto joined = join_rooted(rooted(first), rooted(second), carrier, options, jobs);
  if (!joined) return joined;
  joined->frames = changed(joined->frames, [hips_root, skeleton = first.skeleton](Clip& frames) {
    frames = hips_root.restored(frames, skeleton);
    return Status();
  });
  joined->frames.skeleton = first.skeleton;
  joined->largest_joint = hips_root.original(joined->largest_joint);
  return joined;
}

}  // namespace krok
