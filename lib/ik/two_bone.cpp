#include "ik/two_bone.h"

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok {

namespace {

constexpr double kTiny = 1e-12;

// 0 times a number that is not finite is not 0; one sum is quicker than a test of each.
bool finite(const TwoBoneChain& chain, const TwoBoneGoal& goal) {
  const Vec3 all = 0 * chain.root + 0 * chain.middle + 0 * chain.end + 0 * chain.hinge +
                   0 * goal.target + 0 * goal.pole;
  return all.sum() + 0 * goal.min_bend + 0 * goal.max_bend + 0 * goal.softness == 0;
}

// The length of v; exact where squares would overflow or underflow.
double length_of(const Vec3& v) {
  const double square = v.squaredNorm();
  return square > 1e-200 && square < 1e200 ? std::sqrt(square) : v.stableNorm();
}

// The unit direction of v, or zero if v is too short relative to `scale`.
Vec3 direction(const Vec3& v, double scale = 1.0) {
  const double length = length_of(v);
  return length > kTiny * scale ? Vec3(v * (1 / length)) : Vec3(Vec3::Zero());
}

// v, or v brought to length 1 where its square would overflow or underflow; zero where it is too
// short to have a direction.
Vec3 squarable(const Vec3& v) {
  const double square = v.squaredNorm();
  if (square > 1e-200 && square < 1e200) return square > kTiny * kTiny ? v : Vec3(Vec3::Zero());
  return direction(v);
}

// The part of v perpendicular to the unit vector `along`; zero where there is none.
Vec3 unscaled_perpendicular(const Vec3& v, const Vec3& along) {
  const Vec3 whole = squarable(v);
  const Vec3 part = whole - along * along.dot(whole);
  return part.squaredNorm() > 1e-12 * whole.squaredNorm() ? part : Vec3(Vec3::Zero());
}

// The same, of length 1.
Vec3 perpendicular_part(const Vec3& v, const Vec3& along) {
  const Vec3 part = unscaled_perpendicular(v, along);
  const double square = part.squaredNorm();
  return square > 0 ? Vec3(part * (1 / std::sqrt(square))) : part;
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

// The rotation that takes bone and hinge from where they are to where they shall be. The hinge, of
// any length, is squared to the bone where it is; where it shall be it is perpendicular to it.
Quat frame_rotation(const Vec3& bone_from, const Vec3& hinge_from, const Vec3& bone_to,
                    const Vec3& hinge_to) {
  const Vec3 from = unscaled_perpendicular(hinge_from, bone_from);
  const double square = from.squaredNorm();
  if (square == 0) return shortest_arc(bone_from, bone_to);
  // The bone by the shortest arc, then a turn about it: two half angles by their cosines and sines,
  // all of them scaled alike, so that one division at the end is enough.
  const double w = 1 + bone_from.dot(bone_to);
  const Vec3 axis = bone_from.cross(bone_to);
  const Vec3 across = axis.cross(from);
  // `from` turned by the arc, times w.
  const Vec3 hinge = w * (from + across) + axis.cross(across);
  const double length = w * std::sqrt(square);
  const double turn_w = length + hinge.dot(hinge_to);
  if (w > 0.1 && turn_w > 0.1 * length) {
    const double turn_sine = bone_to.dot(hinge.cross(hinge_to));
    const Vec3 part = turn_w * axis + (turn_sine * w) * bone_to + turn_sine * bone_to.cross(axis);
    const double scalar = turn_w * w - turn_sine * bone_to.dot(axis);
    const double scale = 1 / std::sqrt(scalar * scalar + part.squaredNorm());
    return {scale * scalar, scale * part.x(), scale * part.y(), scale * part.z()};
  }
  const Vec3 unit = from * (1 / std::sqrt(square));
  const Mat3 turn = bone_to * bone_from.transpose() + hinge_to * unit.transpose() +
                    bone_to.cross(hinge_to) * bone_from.cross(unit).transpose();
  return Quat(turn).normalized();
}

// two_bone_reach() with the two ends of the usual range known.
double reach_at(double upper_length, double lower_length, double bend) {
  if (bend <= 0) return upper_length + lower_length;
  if (bend >= kPi) return std::abs(upper_length - lower_length);
  return two_bone_reach(upper_length, lower_length, bend);
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
  const double upper_length = length_of(upper);
  const double lower_length = length_of(lower);
  const double sum = upper_length + lower_length;
  const auto unit = [](const Vec3& v, double length) {
    return length > kTiny ? Vec3(v * (1 / length)) : Vec3(Vec3::Zero());
  };
  const Vec3 upper_now = unit(upper, upper_length);
  const Vec3 lower_now = unit(lower, lower_length);
  if (sum <= kTiny) {
    solution.reached = (chain.end - goal.target).norm() < 1e-9;
    return solution;
  }

  const double max_bend = std::clamp(goal.max_bend, 0.0, kPi);
  const double min_bend = std::clamp(goal.min_bend, 0.0, max_bend);
  const double longest = reach_at(upper_length, lower_length, min_bend);
  const double shortest = reach_at(upper_length, lower_length, max_bend);
  const Vec3 to_target = goal.target - chain.root;
  const double to_target_length = length_of(to_target);
  const double wanted = soft_distance(to_target_length, longest, goal.softness);
  const double distance = std::clamp(wanted, shortest, longest);
  // tan^2(bend / 2) = open / folded.
  const double difference = upper_length - lower_length;
  const double open = std::max(0.0, (sum - distance) * (sum + distance));
  const double folded =
      std::max(0.0, (distance - std::abs(difference)) * (distance + std::abs(difference)));
  const double bend = open == 0 ? 0.0 : 2.0 * std::atan2(std::sqrt(open), std::sqrt(folded));
  // Clamped again: an exact limit must not be missed by rounding.
  solution.bend = std::clamp(bend, min_bend, max_bend);

  // The line from root to end.
  Vec3 line = to_target_length > kTiny * sum ? Vec3(to_target * (1 / to_target_length))
                                             : Vec3(Vec3::Zero());
  if (line.isZero()) line = direction(chain.end - chain.root, sum);
  if (line.isZero()) line = upper_now.isZero() ? lower_now : upper_now;

  // The way the middle points out, and the hinge that goes with it.
  Vec3 present_hinge = squarable(chain.hinge);
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
    // The height of the triangle, by Heron's formula: the sine of the bend without the bend.
    out = solution.bend == bend ? 0.5 * std::sqrt(open * folded) / distance
                                : upper_length * lower_length * std::sin(solution.bend) / distance;
    const double signed_along = (sum * difference + distance * distance) / (2.0 * distance);
    along = std::copysign(std::sqrt(std::max(0.0, upper_length * upper_length - out * out)),
                          signed_along);
  } else {
    out = upper_length;
    along = 0;
  }
  solution.middle = chain.root + line * along + outward * out;
  solution.end = chain.root + line * distance;
  solution.reached = (solution.end - goal.target).norm() < 1e-9;

  const Vec3 upper_new = unit(line * along + outward * out, upper_length);
  const Vec3 lower_new = unit(line * (distance - along) - outward * out, lower_length);
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
