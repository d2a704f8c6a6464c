#include "ik/two_bone.h"

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok {

namespace {

constexpr double kTiny = 1e-12;

bool finite(const TwoBoneChain& chain, const TwoBoneGoal& goal) {
  return chain.root.allFinite() && chain.middle.allFinite() && chain.end.allFinite() &&
         chain.hinge.allFinite() && goal.target.allFinite() && goal.pole.allFinite() &&
         std::isfinite(goal.min_bend) && std::isfinite(goal.max_bend) &&
         std::isfinite(goal.softness);
}

// The unit direction of v, or zero if v is too short relative to `scale`.
Vec3 direction(const Vec3& v, double scale = 1.0) {
  const double length = v.stableNorm();
  return length > kTiny * scale ? Vec3(v / length) : Vec3(Vec3::Zero());
}

// The unit part of v perpendicular to the unit vector `along`; zero if there is none.
Vec3 perpendicular_part(const Vec3& v, const Vec3& along) {
  const Vec3 unit = direction(v);
  const Vec3 part = unit - along * along.dot(unit);
  return part.norm() > 1e-6 ? Vec3(part.normalized()) : Vec3(Vec3::Zero());
}

Vec3 any_perpendicular(const Vec3& along) {
  int least = 0;
  along.cwiseAbs().minCoeff(&least);
  return along.cross(Vec3::Unit(least)).normalized();
}

double soft_distance(double distance, double longest, double softness) {
  const double start = longest - softness;
  if (!(softness > 0) || distance <= start) return distance;
  return start + softness * (1.0 - std::exp(-(distance - start) / softness));
}

// The rotation that maps bone and hinge from their present to their new directions. Both hinges are
// orthogonalised to their bones.
Quat frame_rotation(const Vec3& bone_from, const Vec3& hinge_from, const Vec3& bone_to,
                    const Vec3& hinge_to) {
  const Vec3 from = perpendicular_part(hinge_from, bone_from);
  const Vec3 to = perpendicular_part(hinge_to, bone_to);
  if (from.isZero() || to.isZero()) return shortest_arc(bone_from, bone_to);
  Mat3 before, after;
  before << bone_from, from, bone_from.cross(from);
  after << bone_to, to, bone_to.cross(to);
  return normalized_or_identity(Quat(Mat3(after * before.transpose())));
}

}  // namespace

double two_bone_reach(double upper_length, double lower_length, double bend) {
  // |u a + l b|^2 with an angle of `bend` between the unit vectors a and b, in a form without
  // cancellation when folded.
  const double difference = upper_length - lower_length;
  const double half_cosine = std::cos(0.5 * bend);
  return std::sqrt(difference * difference +
                   4.0 * upper_length * lower_length * half_cosine * half_cosine);
}

double two_bone_bend(double upper_length, double lower_length, double distance) {
  const double sum = upper_length + lower_length;
  const double difference = upper_length - lower_length;
  // tan^2(bend / 2) = (sum^2 - d^2) / (d^2 - difference^2)
  const double open = std::max(0.0, (sum - distance) * (sum + distance));
  const double folded =
      std::max(0.0, (distance - std::abs(difference)) * (distance + std::abs(difference)));
  return open == 0 ? 0.0 : 2.0 * std::atan2(std::sqrt(open), std::sqrt(folded));
}

TwoBoneSolution solve_two_bone(const TwoBoneChain& chain, const TwoBoneGoal& goal) {
  TwoBoneSolution solution;
  solution.middle = chain.middle;
  solution.end = chain.end;
  if (!finite(chain, goal)) return solution;

  const Vec3 upper = chain.middle - chain.root;
  const Vec3 lower = chain.end - chain.middle;
  const double upper_length = upper.norm();
  const double lower_length = lower.norm();
  const double sum = upper_length + lower_length;
  const Vec3 upper_now = direction(upper);
  const Vec3 lower_now = direction(lower);
  if (sum <= kTiny) {
    solution.reached = (chain.end - goal.target).norm() < 1e-9;
    return solution;
  }

  const double max_bend = std::clamp(goal.max_bend, 0.0, kPi);
  const double min_bend = std::clamp(goal.min_bend, 0.0, max_bend);
  const double longest = two_bone_reach(upper_length, lower_length, min_bend);
  const double shortest = two_bone_reach(upper_length, lower_length, max_bend);
  const Vec3 to_target = goal.target - chain.root;
  const double wanted = soft_distance(to_target.norm(), longest, goal.softness);
  const double distance = std::clamp(wanted, shortest, longest);
  // Clamped again so that rounding cannot exceed an exact limit.
  solution.bend =
      std::clamp(two_bone_bend(upper_length, lower_length, distance), min_bend, max_bend);

  // The line from root to end.
  Vec3 line = direction(to_target, sum);
  if (line.isZero()) line = direction(chain.end - chain.root, sum);
  if (line.isZero()) line = upper_now.isZero() ? lower_now : upper_now;

  // The direction in which the middle joint points out, and the matching hinge.
  Vec3 present_hinge = direction(chain.hinge);
  if (present_hinge.isZero()) present_hinge = perpendicular_part(upper_now.cross(lower_now), line);
  Vec3 outward = perpendicular_part(goal.pole, line);
  if (outward.isZero()) outward = perpendicular_part(upper - lower, line);
  if (outward.isZero()) outward = perpendicular_part(line.cross(present_hinge), line);
  if (outward.isZero()) outward = any_perpendicular(line);
  const Vec3 hinge = outward.cross(line);

  // The middle joint is at `along` on the line and `out` beside it: the triangle with the bend as
  // its exterior angle.
  double along = upper_length;
  double out = 0;
  if (distance > kTiny * sum) {
    out = upper_length * lower_length * std::sin(solution.bend) / distance;
    const double signed_along =
        (upper_length * upper_length - lower_length * lower_length + distance * distance) /
        (2.0 * distance);
    along = std::copysign(std::sqrt(std::max(0.0, upper_length * upper_length - out * out)),
                          signed_along);
  } else {
    out = upper_length;
    along = 0;
  }
  solution.middle = chain.root + line * along + outward * out;
  solution.end = chain.root + line * distance;
  solution.reached = (solution.end - goal.target).norm() < 1e-9;

  const Vec3 upper_new = direction(solution.middle - chain.root);
  const Vec3 lower_new = direction(solution.end - solution.middle);
  const auto turn = [&](const Vec3& now, const Vec3& then) {
    if (now.isZero() || then.isZero()) return Quat(Quat::Identity());
    if (present_hinge.isZero()) return shortest_arc(now, then);
    return frame_rotation(now, present_hinge, then, hinge);
  };
  solution.root_rotation = turn(upper_now, upper_new);
  solution.middle_rotation = turn(lower_now, lower_new);
  return solution;
}

}  // namespace krok
