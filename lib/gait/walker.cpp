#include "gait/walker_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/index.h"
#include "gait/foot_paths_internal.h"
#include "math/quaternion.h"
#include "math/window.h"
#include "pose/packed_pose.h"

namespace krok::gait {

Transform joint_of(const PoseVector& pose, int joint) {
  Transform result;
  result.position = position_of(pose, joint);
  result.orientation.coeffs() = rotation_of(pose, joint).normalized();
  return result;
}

Transform joint_to_world(const Skeleton& skeleton, const PoseVector& pose, int joint) {
  Transform result;
  for (int j = joint; j >= 0; j = skeleton.parents[at(j)]) result = joint_of(pose, j) * result;
  return result;
}

PoseVector mean_pose(const parametric::PackedExamples& packed, double generic) {
  std::vector<PoseBlock> blocks(at(packed.reference.blocks_per_pose()));
  std::vector<Transform> local(at(packed.reference.joints));
  sample_pose(packed.reference, generic, blocks);
  unpack_pose(blocks, local);
  PoseVector pose(kPoseValues * packed.reference.joints);
  for (int j = 0; j < packed.reference.joints; ++j) {
    position_of(pose, j) = local[at(j)].position;
    rotation_of(pose, j) = local[at(j)].orientation.coeffs();
  }
  return pose;
}

double middle_of_stance(std::span<const double> times, const parametric::Library& library) {
  const std::size_t runs = index_of_time(library, "stance_off");
  if (runs < times.size()) return std::lerp(times.front(), times[runs], kFlatInRun);
  return std::lerp(times[index_of_time(library, "swing_off")], times.back(), kFlatPart);
}

std::size_t index_of_time(const parametric::Library& library, const char* name) {
  return static_cast<std::size_t>(std::ranges::find(library.keytimes, name) -
                                  library.keytimes.begin());
}

namespace {

constexpr int kMeanSamples = 32;                     // of a step, for means over it
constexpr double kRaised = 0.004;                    // metres
constexpr double kRaisedInRun = 0.012;               // the toes push on
constexpr double kEarliestOff = 0.15;                // of the time to the off
constexpr double kMinPitch = 2 * kRadiansPerDegree;  // of a foot that shows how round its heel is
constexpr double kMaxHeelRadius = 0.55;              // of the length of the sole behind the ankle
constexpr double kStandingLeg = 0.994;               // of the length: nearly straight
constexpr double kToeShare = 0.35;  // of the sole, from the ball to the tip, where no end site is

FootGeometry geometry_of(const parametric::FootShape& shape, const Vec3& up) {
  FootGeometry foot;
  foot.heel = shape.heel;
  foot.ball = ball_of(shape);
  foot.length = shape.length;
  const Vec3 left = up.cross(shape.forward).normalized();
  Mat3 axes;
  axes << left, shape.forward.cross(left), shape.forward;
  foot.sole = Quat(axes);
  return foot;
}

// The distance from the ball to the tip of the toes: the farthest joint below the foot, along the
// sole.
double toe_length(const Skeleton& skeleton, int foot, const FootGeometry& sole) {
  double farthest = 0;
  const Transform to_foot = skeleton.reference[at(foot)].inverse();
  for (int j = foot + 1; j < skeleton.joint_count(); ++j) {
    if (!is_below(skeleton, j, foot)) continue;
    const Vec3 point = to_foot * skeleton.reference[at(j)].position;
    farthest = std::max(farthest, (sole.sole.conjugate() * (point - sole.ball)).z());
  }
  return farthest > 0.1 * sole.length ? farthest : kToeShare * sole.length;
}

// As a foot strikes with its toes up, the corner of its heel is lower than where it is flat: that
// much lies outside of a round heel. The median of the examples.
double heel_radius(const parametric::Library& library, const Leg& leg) {
  std::vector<double> radii;
  for (const parametric::Example& example : library.examples) {
    const auto sole_at = [&](double time) {
      const Clip& clip = example.motion;
      const int frame =
          std::min(static_cast<int>(std::lround(time * clip.rate)), clip.frame_count() - 1);
      const Transform foot = joint_at(clip, frame, leg.foot);
      return Transform{foot * leg.sole.heel, foot.orientation * leg.sole.sole};
    };
    const Transform flat = sole_at(middle_of_stance(example.keytimes, library));
    const Transform strike = flat.inverse() * sole_at(example.keytimes.front());
    const double pitch = std::asin(std::clamp((strike.orientation * Vec3::UnitZ()).y(), -1.0, 1.0));
    if (pitch < kMinPitch) continue;
    radii.push_back(-strike.position.y() / (std::cos(pitch) + std::sin(pitch) - 1));
  }
  if (radii.empty()) return 0;
  const double behind = -(leg.sole.sole.conjugate() * leg.sole.heel).z();
  return std::clamp(median(std::move(radii)), 0.0, std::max(0.0, kMaxHeelRadius * behind));
}

// Takes the geometry of the flat foot from the middle of the stance in the mean step.
void learn_flat_foot(const StepLibrary& steps, FootSide side, Walker& walker) {
  const parametric::Synthesiser& stance = steps.steps(other(side));
  const PoseVector pose =
      mean_pose(stance.packed(), middle_of_stance(stance.packed().generic, stance.library()));
  std::vector<Transform> world(walker.skeleton->names.size());
  walker.to_world(pose, world);
  Leg& leg = walker.legs[index_of(side)];
  const Transform& foot = world[at(leg.foot)];
  const Vec3 up = foot.orientation.conjugate() * Vec3::UnitY();
  leg.sole = geometry_of(steps.library().foot(side), up);
  leg.sole.pivot = leg.sole.ball;
  leg.sole.tip = toe_length(*walker.skeleton, leg.foot, leg.sole);
  if (leg.toes >= 0) {
    leg.sole.pivot = foot.inverse() * world[at(leg.toes)].position;
    leg.flat_toes =
        world[at(leg.toes)].orientation.conjugate() * (foot.orientation * leg.sole.sole);
  }
  leg.sole.heel_radius = heel_radius(stance.library(), leg);
}

void learn_knee(const StepLibrary& steps, FootSide side, Walker& walker) {
  Leg& leg = walker.legs[index_of(side)];
  std::vector<Transform> world(walker.skeleton->names.size());
  Vec3 sum = Vec3::Zero();
  for (const FootSide swing : {FootSide::left, FootSide::right}) {
    const parametric::PackedExamples& packed = steps.steps(swing).packed();
    for (int i = 0; i <= kMeanSamples; ++i) {
      walker.to_world(mean_pose(packed, packed.generic.back() * i / kMeanSamples), world);
      const Transform& hip = world[at(leg.upper)];
      const Vec3& knee = world[at(leg.lower)].position;
      const Vec3 thigh = knee - hip.position, shank = world[at(leg.foot)].position - knee;
      leg.length = thigh.norm() + shank.norm();
      sum += hip.orientation.conjugate() * thigh.cross(shank);
    }
  }
  if (sum.norm() > 1e-9) leg.knee_axis = sum.normalized();
}

// Generic time of the swing foot's off, seconds; in a run it is off before the step.
double off_of_swing(const parametric::Synthesiser& step) {
  const std::size_t off = index_of_time(step.library(), "swing_off");
  return off < step.packed().generic.size() ? step.packed().generic[off] : 0;
}

// Joints that keep their place in their parents, within a centimetre in each example. They are
// fixed to that of the reference pose, because rounding in captures and mirror images of unequal
// sides, whose bones are as long as the other side's, change bone lengths.
std::vector<FixedJoint> fixed_joints(const StepLibrary& steps) {
  constexpr double kMoves = 0.01, kUnequal = 0.05;  // metres
  const parametric::PackedExamples& packed = steps.steps(FootSide::left).packed();
  const auto count = static_cast<std::size_t>(packed.skeleton.joint_count());
  std::vector<std::uint8_t> moves(count, 0);
  std::vector<PoseBlock> blocks(at(packed.reference.blocks_per_pose()));
  std::vector<Transform> local(count), first(count);
  for (const PackedClip& clip : packed.clips) {
    for (int f = 0; f < clip.frames; ++f) {
      sample_pose(clip, f / clip.rate, blocks);
      unpack_pose(blocks, local);
      if (f == 0) first = local;
      for (std::size_t j = 1; j < count; ++j) {
        const Vec3 place = packed.skeleton.reference_local(static_cast<int>(j)).position;
        if ((local[j].position - first[j].position).norm() >= kMoves ||
            (local[j].position - place).norm() >= kUnequal) {
          moves[j] = 1;
        }
      }
    }
  }
  std::vector<FixedJoint> fixed;
  for (int j = 1; j < packed.skeleton.joint_count(); ++j) {
    if (moves[at(j)] != 0) continue;
    fixed.push_back({j, packed.skeleton.reference_local(j).position});
  }
  return fixed;
}

// The ball is off the ground when it has come up by kRaised in the mean step.
double find_ball_off(const StepLibrary& steps, const Walker& walker) {
  const parametric::Synthesiser& step = steps.steps(steps.library().swing);
  const parametric::PackedExamples& packed = step.packed();
  const Leg& leg = walker.leg(steps.library().swing);
  std::vector<Transform> world(walker.skeleton->names.size());
  double first = 0;
  for (int i = 0; i <= kMeanSamples; ++i) {
    const double part = static_cast<double>(i) / kMeanSamples;
    walker.to_world(mean_pose(packed, off_of_swing(step) * part), world);
    const double height = (world[at(leg.foot)] * leg.sole.pivot).y();
    if (i == 0) first = height;
    if (height - first > kRaised) return std::max(part, kEarliestOff);
  }
  return 1;
}

// The same of the stance foot of runs, after it was flat.
double find_run_off(const StepLibrary& runs, const Walker& walker) {
  const parametric::Synthesiser& step = runs.steps(runs.library().swing);
  const parametric::PackedExamples& packed = step.packed();
  const Leg& leg = walker.leg(runs.library().stance());
  const double off = packed.generic[index_of_time(step.library(), "stance_off")];
  std::vector<Transform> world(walker.skeleton->names.size());
  double lowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kMeanSamples; ++i) {
    const double part = std::lerp(kFlatInRun, 1, static_cast<double>(i) / kMeanSamples);
    walker.to_world(mean_pose(packed, off * part), world);
    const double height = (world[at(leg.foot)] * leg.sole.pivot).y();
    lowest = std::min(lowest, height);
    if (height - lowest > kRaisedInRun) return part;
  }
  return 1;
}

// Adds a pose to a sum, quaternions in one hemisphere.
void add_pose(const PoseVector& pose, PoseVector& sum) {
  if (sum.size() == 0) {
    sum = pose;
    return;
  }
  for (int j = 0; j < pose.size() / kPoseValues; ++j) {
    position_of(sum, j) += position_of(pose, j);
    const double sign = rotation_of(sum, j).dot(rotation_of(pose, j)) < 0 ? -1 : 1;
    rotation_of(sum, j) += sign * rotation_of(pose, j);
  }
}

void divide_poses(double count, PoseVector& sum) {
  for (int j = 0; j < sum.size() / kPoseValues; ++j) {
    position_of(sum, j) /= count;
    rotation_of(sum, j).normalize();
  }
}

// The mean standing pose of captures and of its mirror image, above the middle of the ankles.
PoseVector captured_stand(const StepLibrary& stands, const Walker& walker) {
  PoseVector sum;
  std::vector<Transform> world(walker.skeleton->names.size());
  for (const FootSide swing : {FootSide::left, FootSide::right}) {
    const parametric::PackedExamples& packed = stands.steps(swing).packed();
    const double when = stands.kind() == StepKind::stop    ? packed.generic.back()
                        : stands.kind() == StepKind::stand ? 0.5 * packed.generic.back()
                                                           : 0;
    PoseVector pose = mean_pose(packed, when);
    walker.to_world(pose, world);
    Vec3 middle = Vec3::Zero();
    for (const Leg& leg : walker.legs) middle += 0.5 * world[at(leg.foot)].position;
    position_of(pose, 0) -= Vec3(middle.x(), 0, middle.z());
    // The pose is in the frame of the stance foot's toes.
    const double out = stands.toe_out() * (swing == FootSide::left ? -1 : 1);
    const Quat turn = axis_rotation(Axis::y, out);
    position_of(pose, 0) = turn * Vec3(position_of(pose, 0));
    rotation_of(pose, 0) = (turn * joint_of(pose, 0).orientation).coeffs();
    add_pose(pose, sum);
  }
  divide_poses(2, sum);
  return sum;
}

// The mean pose over a step of each foot, upright on straight legs, the arms down. Its root is
// above the middle of the ankles.
PoseVector standing_pose(const StepLibrary& steps, const Walker& walker) {
  PoseVector sum;
  std::vector<Transform> world(walker.skeleton->names.size());
  for (const FootSide swing : {FootSide::left, FootSide::right}) {
    const parametric::Synthesiser& step = steps.steps(swing);
    const parametric::PackedExamples& packed = step.packed();
    for (int i = 0; i < kMeanSamples; ++i) {
      const PoseVector pose = mean_pose(packed, packed.generic.back() * i / kMeanSamples);
      add_pose(pose, sum);
    }
  }
  divide_poses(2 * kMeanSamples, sum);
  // The hips as high as legs that are nearly straight carry them, feet flat below.
  position_of(sum, 0) = Vec3::Zero();
  walker.to_world(sum, world);
  const auto height_of_ankle = [](const Leg& leg) {
    return (leg.sole.sole.conjugate() * -leg.sole.heel).y();
  };
  double height = std::numeric_limits<double>::infinity();
  for (const Leg& leg : walker.legs) {
    const Vec3& hip = world[at(leg.upper)].position;
    const double longest = kStandingLeg * leg.length;
    const double up = std::sqrt(std::max(0.0, longest * longest - hip.z() * hip.z()));
    height = std::min(height, height_of_ankle(leg) + up - hip.y());
  }
  position_of(sum, 0) = Vec3(0, height, 0);
  walker.to_world(sum, world);
  std::array<FootPose, 2> flat;
  for (std::size_t side = 0; side < 2; ++side) {
    const Leg& leg = walker.legs[side];
    flat[side].foot = {Vec3(world[at(leg.upper)].position.x(), height_of_ankle(leg), 0),
                       leg.sole.sole.conjugate()};
    flat[side].toes = leg.flat_toes.conjugate();
  }
  solve_legs(walker, flat, 0, sum, world);
  return sum;
}

}  // namespace

double ankle_angle(const Leg& leg, std::span<const Transform> world) {
  const Transform& foot = world[at(leg.foot)];
  const Vec3 shank = (world[at(leg.lower)].position - foot.position).normalized();
  const Vec3 forward = foot.orientation * (leg.sole.sole * Vec3::UnitZ());
  return std::acos(std::clamp(shank.dot(forward), -1.0, 1.0));
}

void Walker::to_world(const PoseVector& pose, std::span<Transform> joint_to_world) const {
  for (std::size_t j = 0; j < joint_to_world.size(); ++j) {
    const int parent = skeleton->parents[j];
    const Transform local = joint_of(pose, static_cast<int>(j));
    joint_to_world[j] = parent < 0 ? local : joint_to_world[at(parent)] * local;
  }
}

Result<Walker> make_walker(std::span<const StepLibrary> libraries) {
  const StepLibrary& steps = main_library(libraries);
  Walker walker;
  walker.skeleton = &steps.steps(FootSide::left).packed().skeleton;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    Leg& leg = walker.legs[index_of(side)];
    static_cast<LegJoints&>(leg) = leg_joints(steps.roles(), side);
    if (leg.upper < 0 || leg.lower < 0 || leg.foot != steps.library().foot(side).joint) {
      return Error("walk-legs", "the skeleton has no known legs of thigh, shank and foot",
                   "assign their joints with --map");
    }
    for (int j = leg.toes >= 0 ? leg.toes : leg.foot; j >= leg.upper;
         j = walker.skeleton->parents[at(j)]) {
      leg.path.insert(leg.path.begin(), j);
    }
    learn_flat_foot(steps, side, walker);
  }
  for (const FootSide side : {FootSide::left, FootSide::right}) learn_knee(steps, side, walker);
  walker.spine = steps.roles().joint(Role::spine);
  if (walker.spine < 0) walker.spine = steps.roles().joint(Role::chest);
  walker.neck = steps.roles().joint(Role::neck);
  walker.bones = fixed_joints(steps);
  walker.ball_off = find_ball_off(steps, walker);
  walker.usual_off = off_of_swing(steps.steps(FootSide::left));
  const auto runs = std::ranges::find(libraries, StepKind::run, &StepLibrary::kind);
  walker.runs = runs != libraries.end();
  if (walker.runs) walker.run_off = find_run_off(*runs, walker);
  walker.stand = standing_pose(steps, walker);
  for (const StepKind kind : {StepKind::stand, StepKind::start, StepKind::stop}) {
    const auto found = std::ranges::find(libraries, kind, &StepLibrary::kind);
    if (found == libraries.end()) continue;
    walker.stand = captured_stand(*found, walker);
    break;
  }
  for (const FixedJoint& bone : walker.bones) {
    position_of(walker.stand, bone.joint) = bone.place;
  }
  std::vector<Transform> world(walker.skeleton->names.size());
  walker.to_world(walker.stand, world);
  for (Leg& leg : walker.legs) leg.standing_ankle = ankle_angle(leg, world);
  return walker;
}

}  // namespace krok::gait
