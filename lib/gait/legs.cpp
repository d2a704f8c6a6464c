#include "gait/legs_internal.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/two_bone.h"

namespace krok::gait {

namespace {

constexpr double kNearlyStraight = 0.985;  // of the leg: beyond this a knee turns far for little
// The most that a leg is stretched where the blend's is: nearer to straight, a footprint that is
// off by two millimetres is a knee that turns by six degrees in a frame.
constexpr double kMaxStraight = 0.994;
constexpr double kStraight = 0.9995;

}  // namespace

double lowering_for(const Walker& walker, std::span<const Transform> joint_to_world,
                    const std::array<FootPose, 2>& target) {
  double lowest = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    const Leg& leg = walker.legs[side];
    const Vec3& hip = joint_to_world[at(leg.upper)].position;
    const double blend = (hip - joint_to_world[at(leg.foot)].position).norm();
    const double longest =
        std::max(kNearlyStraight * leg.length, std::min(blend, kMaxStraight * leg.length));
    const Vec3 way = hip - target[side].foot.position;
    const double level = std::hypot(way.x(), way.z());
    if (way.norm() <= longest) continue;
    const double height = std::sqrt(std::max(0.0, longest * longest - level * level));
    lowest = std::max(lowest, way.y() - height);
  }
  return std::min(lowest, 0.6 * walker.legs[0].length);
}

std::vector<double> smooth_above(std::span<const double> needs, int reach) {
  const int count = static_cast<int>(needs.size());
  std::vector<double> result(needs.begin(), needs.end());
  if (reach < 1 || std::ranges::all_of(needs, [](double need) { return need == 0; })) {
    return result;
  }
  const auto clamped = [&](int i) { return at(std::clamp(i, 0, count - 1)); };
  // Twice averaged over 2 half + 1 frames, a value spreads over 2 half on either side.
  const int half = std::max(1, reach / 2);
  std::vector<double> highest(needs.size());
  for (int i = 0; i < count; ++i) {
    double high = 0;
    for (int k = -2 * half; k <= 2 * half; ++k) high = std::max(high, needs[clamped(i + k)]);
    highest[at(i)] = high;
  }
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < count; ++i) {
      double sum = 0;
      for (int k = -half; k <= half; ++k) sum += highest[clamped(i + k)];
      result[at(i)] = sum / (2 * half + 1);
    }
    highest = result;
  }
  return result;
}

SolvedLegs solve_legs(const Walker& walker, const std::array<FootPose, 2>& target, double stretch,
                      PoseVector& pose, std::span<Transform> world) {
  SolvedLegs solved;
  const auto refresh = [&](const Leg& leg, int joint) {
    // The path from thigh to toes, joint by joint: helpers in between move along.
    for (const int j : leg.path) {
      if (j < joint) continue;
      world[at(j)] = world[at(walker.skeleton->parents[at(j)])] * joint_of(pose, j);
    }
  };
  const auto turn_to = [&](const Leg& leg, int joint, const Quat& orientation) {
    const Quat parent = world[at(walker.skeleton->parents[at(joint)])].orientation;
    rotation_of(pose, joint) = (parent.conjugate() * orientation).normalized().coeffs();
    refresh(leg, joint);
  };
  for (std::size_t side = 0; side < 2; ++side) {
    const Leg& leg = walker.legs[side];
    const Transform hip = world[at(leg.upper)];
    const Quat knee = world[at(leg.lower)].orientation;
    const Vec3 axis = hip.orientation * leg.knee_axis;
    const Vec3& goal = target[side].foot.position;
    const double distance = (goal - hip.position).norm();
    const double longer = std::clamp(distance - kStraight * leg.length, 0.0, stretch);
    if (longer > 0) {
      const double factor = (leg.length + longer) / leg.length;
      position_of(pose, leg.lower) *= factor;
      position_of(pose, leg.foot) *= factor;
      refresh(leg, leg.upper);
    }
    TwoBoneChain chain{hip.position, world[at(leg.lower)].position, world[at(leg.foot)].position,
                       axis};
    const auto solution =
        solve_two_bone(chain, {.target = goal, .pole = (goal - hip.position).cross(axis)});
    turn_to(leg, leg.upper, solution.root_rotation * hip.orientation);
    turn_to(leg, leg.lower, solution.middle_rotation * knee);
    turn_to(leg, leg.foot, target[side].foot.orientation);
    if (leg.toes >= 0) turn_to(leg, leg.toes, target[side].toes);
    solved.extension = std::max(solved.extension, distance / leg.length);
    solved.missed = std::max(solved.missed, (world[at(leg.foot)].position - goal).norm());
  }
  return solved;
}

}  // namespace krok::gait
