#include "samples/generator/body_motion.h"

#include <algorithm>
#include <cmath>

#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "samples/generator/gait_curves.h"

namespace krok::samples {

namespace {

// A walking knee is never fully extended, and more flexed in long steps, or it would snap straight
// before each strike.
double least_knee_flexion(double activity) {
  return (4 + 18 * std::max(0.0, activity - 1)) * kRadiansPerDegree;
}
constexpr double kStandingKneeFlexion = 6 * kRadiansPerDegree;
// Of the slope of the ground: by which the line from hip to ankle tilts against gravity, and the
// knee bends more in mid-stance, up or down (Reznick and others, Scientific Data 8, 2021); and by
// which the trunk leans (Leroux, Fung, Barbeau, Gait & Posture 15, 2002).
constexpr double kTilt = 0.5, kKneeUp = 0.95, kKneeDown = 1.2, kLeanUp = 0.6, kLeanDown = 0.25;
constexpr double kHeightSpacing = 1.0 / 120.0;  // seconds between height keys
constexpr double kHeightSmoothing = 0.045;      // seconds, standard deviation

template <typename T, typename Key>
Spline<T> over_prints(const FootPlan& plan, Key key) {
  std::vector<T> keys;
  for (std::size_t i = 0; i < plan.prints.size(); ++i) {
    keys.push_back(key(plan.prints[i == 0 ? 0 : i - 1], plan.prints[i]));
  }
  return Spline<T>(std::move(keys), 0, plan.step_time);
}

// Mirrors a rotation of the left side at the plane x = 0 if `side` is right.
Quat on_side(Side side, const Quat& left) {
  return side == Side::left ? left : Quat(left.w(), left.x(), -left.y(), -left.z());
}

// Fraction of body weight on a foot: 0 in swing, 1 in single support.
double load(const Footprint& print, double stride, double time) {
  const double double_support = (kToeOff - 0.5) * stride;
  const double on = print.first_of_foot ? 1 : ease((time - print.strike) / double_support);
  const double off = print.last_of_foot ? 0 : ease((time - print.off) / double_support + 1);
  return on - off;
}

}  // namespace

BodyMotion::BodyMotion(const WalkOptions& options, const Actor& actor, const FootPlan& plan)
    : options_(options),
      actor_(actor),
      plan_(plan),
      feet_{FootMotion(Side::left, plan, actor), FootMotion(Side::right, plan, actor)},
      path_(over_prints<Vec3>(plan,
                              [](const Footprint& a, const Footprint& b) {
                                return Vec3(0.5 * (a.path_point + b.path_point));
                              })),
      heading_(over_prints<double>(plan,
                                   [](const Footprint& a, const Footprint& b) {
                                     return 0.5 * (a.path_heading + b.path_heading);
                                   })),
      activity_(over_prints<double>(plan,
                                    [&](const Footprint&, const Footprint& b) {
                                      return std::min(1.3,
                                                      b.step_length / (0.41 * options.stature));
                                    })),
      height_({0.0}, 0, 1) {
  plan_height();
}

double BodyMotion::left_phase(double time) const {
  const Footprint& first = plan_.prints[0];
  const double offset = first.side == Side::left ? 0 : 0.5;
  return time / (2 * plan_.step_time) + offset;
}

Transform BodyMotion::pelvis_without_height(double time) const {
  const double phase = left_phase(time);
  const double activity = activity_(time);
  const double heading = heading_(time);
  const double stature = actor_.stature;

  // Sway towards the stance foot, largest at mid single support, phase 0.31.
  const double moving = std::min(1.0, 2.5 * activity);
  const double sway = 0.018 * stature / 1.75 * moving * std::cos(2 * kPi * (phase - 0.31));
  // In front of the ankles: at a strike the trailing leg reaches further than the leading one.
  // Slightly faster in double than in single support.
  const double slope = plan_.prints.front().slope;
  const double ahead = 0.046 * stature + 0.006 * activity * std::sin(4 * kPi * (phase + 0.03)) -
                       std::tan(kTilt * slope) * (actor_.thigh + actor_.shank);
  Transform pelvis;
  pelvis.position = path_(time) + left_of(heading) * sway + forward_of(heading) * ahead;
  pelvis.position.y() = 0;
  const double tilt = (2 + 1.2 * activity * std::cos(4 * kPi * (phase - 0.05))) * kRadiansPerDegree;
  pelvis.orientation = axis_rotation(Axis::y, heading + activity * pelvis_rotation(phase)) *
                       axis_rotation(Axis::z, moving * pelvis_list(phase)) *
                       axis_rotation(Axis::x, tilt);
  return pelvis;
}

Transform BodyMotion::pelvis(double time) const {
  Transform pelvis = pelvis_without_height(time);
  pelvis.position.y() = height_(time);
  return pelvis;
}

// The hip height at which the distance from hip to ankle is `reach`, the length of the flexed leg.
static double hip_height(const Vec3& hip, const Vec3& ankle, double reach) {
  const double across = Vec2(hip.x() - ankle.x(), hip.z() - ankle.z()).norm();
  return ankle.y() + std::sqrt(std::max(0.0, reach * reach - across * across));
}

double BodyMotion::level_height(double time) const {
  const Transform pelvis = pelvis_without_height(time);
  const double stride = 2 * plan_.step_time;
  const double activity = std::clamp(activity_(time), 0.0, 1.0);
  const double slope = plan_.prints.front().slope;
  double height = 0;
  double weight = 0;
  for (const Side side : {Side::left, Side::right}) {
    const FootMotion& foot = feet_[static_cast<std::size_t>(side)];
    const Footprint& print = foot.print_at(time);
    const double carried = load(print, stride, time);
    if (carried <= 0) continue;
    // Phase of the stance; a longer stance is extended in the middle.
    double phase =
        print.first_of_foot ? kHeelRise : std::min(kHeelRise, (time - print.strike) / stride);
    if (!print.last_of_foot) phase = std::max(phase, kToeOff - (print.off - time) / stride);
    const double flexion =
        std::max(least_knee_flexion(activity_(time)),
                 kStandingKneeFlexion + activity * (knee_flexion(phase) - kStandingKneeFlexion)) +
        activity * (slope > 0 ? kKneeUp : kKneeDown) * std::abs(slope);
    const Vec3 hip_local =
        actor_.skeleton.reference_local(actor_.legs[static_cast<std::size_t>(side)].upper).position;
    const Vec3 hip = pelvis * hip_local;
    const double reach = two_bone_reach(actor_.thigh, actor_.shank, flexion);
    height += carried * (hip_height(hip, foot.at(time).ankle, reach) - hip.y());
    weight += carried;
  }
  return height / weight;
}

// On stairs the body rises steadily while the leading knee, flexed according to its lead, extends.
double BodyMotion::stairs_height(double time) const {
  const Vec3 hip = actor_.skeleton.reference_local(actor_.legs[0].upper).position;
  const double standing =
      two_bone_reach(actor_.thigh, actor_.shank, kStandingKneeFlexion) - actor_.heel.y() - hip.y();
  const double moving = std::min(1.0, 2.5 * activity_(time));
  return path_(time).y() + standing - 0.3 * moving * std::abs(plan_.rise);
}

double BodyMotion::highest(double time) const {
  const Transform pelvis = pelvis_without_height(time);
  const double reach =
      two_bone_reach(actor_.thigh, actor_.shank, least_knee_flexion(activity_(time)));
  double height = 1e30;
  for (const Side side : {Side::left, Side::right}) {
    const Vec3 hip_local =
        actor_.skeleton.reference_local(actor_.legs[static_cast<std::size_t>(side)].upper).position;
    const Vec3 hip = pelvis * hip_local;
    const Vec3 ankle = feet_[static_cast<std::size_t>(side)].at(time).ankle;
    height = std::min(height, hip_height(hip, ankle, reach) - hip.y());
  }
  return height;
}

// The stance leg carries the pelvis: its knee flexion determines the height. The result is
// smoothed, and then smoothly lowered where a leg could not reach its foot.
void BodyMotion::plan_height() {
  const double margin = 1.0;
  const double start = plan_.first_time - margin;
  const auto count =
      static_cast<std::size_t>((plan_.last_time - plan_.first_time + 2 * margin) / kHeightSpacing) +
      1;
  const double on_stairs = plan_.ground == Ground::stairs
                               ? std::min(1.0, std::abs(plan_.rise) / (0.05 * actor_.stature))
                               : 0;
  std::vector<double> heights(count), limits(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double time = start + static_cast<double>(i) * kHeightSpacing;
    heights[i] = (1 - on_stairs) * level_height(time) + on_stairs * stairs_height(time);
    limits[i] = highest(time);
  }
  const double sigma = kHeightSmoothing / kHeightSpacing;
  smooth(heights, sigma);
  for (int round = 0; round < 40; ++round) {
    std::vector<double> excess(count);
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      excess[i] = std::max(0.0, heights[i] - limits[i]);
      largest = std::max(largest, excess[i]);
    }
    if (largest < 1e-5) break;
    smooth(excess, sigma);
    for (std::size_t i = 0; i < count; ++i) heights[i] -= 1.5 * excess[i];
  }
  height_ = Spline<double>(std::move(heights), start, kHeightSpacing);
}

void BodyMotion::pose_trunk(double time, std::span<Transform> world) const {
  const double phase = left_phase(time);
  const double activity = activity_(time);
  const double heading = heading_(time);
  const auto place = [&](int joint, const Quat& orientation) {
    const auto index = static_cast<std::size_t>(joint);
    const auto parent = static_cast<std::size_t>(actor_.skeleton.parents[index]);
    world[index].position = world[parent] * actor_.skeleton.reference_local(joint).position;
    world[index].orientation = orientation;
  };
  // The shoulders counter-rotate with a small delay relative to the pelvis, and stay nearly level.
  const double turn = activity * 5.5 * kRadiansPerDegree * std::cos(2 * kPi * (phase - 0.03));
  const double list = -0.35 * std::min(1.0, 2.5 * activity) * pelvis_list(phase);
  const double slope = plan_.prints.front().slope;
  const double climb = plan_.ground == Ground::stairs ? plan_.rise / (0.1 * actor_.stature) : 0;
  const double lean = (2.0 + 1.5 * activity + 1.0 * activity * std::sin(4 * kPi * (phase - 0.05)) +
                       6.0 * std::max(0.0, climb) * std::min(1.0, 2.5 * activity)) *
                          kRadiansPerDegree +
                      (slope > 0 ? kLeanUp : kLeanDown) * slope;
  const Quat chest = axis_rotation(Axis::y, heading + turn) * axis_rotation(Axis::z, list) *
                     axis_rotation(Axis::x, lean);
  const Quat hips = world[static_cast<std::size_t>(actor_.hips)].orientation;
  place(actor_.spine, slerp(hips, chest, 0.3));
  place(actor_.spine1, slerp(hips, chest, 0.65));
  place(actor_.spine2, chest);
  // The head stays level and looks ahead along the path.
  const double ahead = heading_(time + 0.35);
  const Quat head =
      axis_rotation(Axis::y, ahead + 0.15 * turn) *
      axis_rotation(
          Axis::x, (1.5 - 0.6 * activity * std::sin(4 * kPi * (phase - 0.05))) * kRadiansPerDegree);
  place(actor_.neck, slerp(chest, head, 0.5) * axis_rotation(Axis::x, 6 * kRadiansPerDegree));
  place(actor_.head, head);
}

void BodyMotion::pose_arm(Side side, double time, std::span<Transform> world) const {
  const ArmJoints& arm = actor_.arms[static_cast<std::size_t>(side)];
  const double own_phase = left_phase(time) + (side == Side::left ? 0 : 0.5);
  const double activity = activity_(time);
  const double swing = std::min(1.15, activity);
  const double flexion = swing * shoulder_flexion(own_phase) + (1 - swing) * 1 * kRadiansPerDegree;
  const double elbow =
      swing * elbow_flexion(own_phase - 0.02) + (1 - swing) * 16 * kRadiansPerDegree;
  const double abduction = 9 * kRadiansPerDegree;

  const auto set = [&](int joint, const Quat& left_local) {
    const auto index = static_cast<std::size_t>(joint);
    const auto parent = static_cast<std::size_t>(actor_.skeleton.parents[index]);
    world[index] = world[parent] * Transform{actor_.skeleton.reference_local(joint).position,
                                             on_side(side, left_local)};
  };
  // In the frame of the left arm the bone is along +X; hanging down, +Y points away from the body
  // and +Z forward.
  set(arm.collar,
      axis_rotation(Axis::y, -0.12 * flexion) * axis_rotation(Axis::z, -3 * kRadiansPerDegree));
  set(arm.upper, axis_rotation(Axis::x, -flexion) *
                     axis_rotation(Axis::z, -(kPi / 2 - abduction) + 3 * kRadiansPerDegree) *
                     axis_rotation(Axis::x, 22 * kRadiansPerDegree));
  set(arm.lower, axis_rotation(Axis::y, -elbow) * axis_rotation(Axis::x, -12 * kRadiansPerDegree));
  set(arm.hand, axis_rotation(Axis::z, (-6 - 4 * std::sin(2 * kPi * (own_phase - 0.1)) * swing) *
                                           kRadiansPerDegree));
  set(arm.fingers, axis_rotation(Axis::z, -24 * kRadiansPerDegree));
}

void BodyMotion::pose_leg(Side side, double time, std::span<Transform> world) const {
  const LegJoints& leg = actor_.legs[static_cast<std::size_t>(side)];
  const auto upper = static_cast<std::size_t>(leg.upper);
  const auto lower = static_cast<std::size_t>(leg.lower);
  const auto foot = static_cast<std::size_t>(leg.foot);
  const auto toes = static_cast<std::size_t>(leg.toes);
  const Transform& hips = world[static_cast<std::size_t>(actor_.hips)];
  const FootPose planned = feet_[static_cast<std::size_t>(side)].at(time);

  // The knee direction is between those of the pelvis and the foot, closer to the foot.
  const Vec3 foot_forward = (planned.foot * Vec3(Vec3::UnitX())).cross(Vec3(Vec3::UnitY()));
  const Vec3 hips_forward = (hips.orientation * Vec3(Vec3::UnitX())).cross(Vec3(Vec3::UnitY()));
  TwoBoneChain chain;
  chain.root = hips * actor_.skeleton.reference_local(leg.upper).position;
  chain.middle = chain.root + hips.orientation * Vec3(0, -actor_.thigh, 0);
  chain.end = chain.middle + hips.orientation * Vec3(0, -actor_.shank, 0);
  chain.hinge = hips.orientation * Vec3(Vec3::UnitX());
  TwoBoneGoal goal;
  goal.target = planned.ankle;
  goal.pole = 0.65 * foot_forward + 0.35 * hips_forward;
  const TwoBoneSolution solved = solve_two_bone(chain, goal);
  world[upper] = {chain.root, solved.root_rotation * hips.orientation};
  world[lower] = {solved.middle, solved.middle_rotation * hips.orientation};
  world[foot] = {solved.end, planned.foot};
  world[toes] = {world[foot] * actor_.toe_joint, planned.toes};
}

void BodyMotion::pose(double time, std::span<Transform> world) const {
  world[static_cast<std::size_t>(actor_.hips)] = pelvis(time);
  pose_trunk(time, world);
  for (const Side side : {Side::left, Side::right}) {
    pose_arm(side, time, world);
    pose_leg(side, time, world);
  }
  for (int i = 0; i < actor_.skeleton.joint_count(); ++i) {
    const auto index = static_cast<std::size_t>(i);
    if (!actor_.skeleton.end_sites[index]) continue;
    const auto parent = static_cast<std::size_t>(actor_.skeleton.parents[index]);
    world[index] = world[parent] * actor_.skeleton.reference_local(i);
  }
}

}  // namespace krok::samples
