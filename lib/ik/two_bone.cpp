#include "ik/two_bone.h"

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok {

namespace {

constexpr double kTiny = 1e-12;

// A sum is quicker than a test of each. 0 times a sum that is not finite is not 0; sums of finite
// numbers overflow only where these are beyond any use, which the second look is for.
bool finite(const TwoBoneChain& chain, const TwoBoneGoal& goal) {
  const Vec3 sum =
      (chain.root + chain.middle) + (chain.end + chain.hinge) + (goal.target + goal.pole);
  const double limits = goal.min_bend + goal.max_bend + goal.softness;
  if (0 * (sum.x() + sum.y() + sum.z() + limits) == 0) return true;
  return chain.root.allFinite() && chain.middle.allFinite() && chain.end.allFinite() &&
         chain.hinge.allFinite() && goal.target.allFinite() && goal.pole.allFinite() &&
         std::isfinite(goal.min_bend) && std::isfinite(goal.max_bend) &&
         std::isfinite(goal.softness);
}

// Exactly; Vec3::isZero() takes its time to allow for rounding.
bool is_zero(const Vec3& v) {
  return v.x() == 0 && v.y() == 0 && v.z() == 0;
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
inline Vec3 squarable(const Vec3& v) {
  const double square = v.squaredNorm();
  if (square > 1e-200 && square < 1e200) return square > kTiny * kTiny ? v : Vec3(Vec3::Zero());
  return direction(v);
}

// The part of v perpendicular to the unit vector `along`, of length 1; zero where there is none.
inline Vec3 perpendicular_part(const Vec3& v, const Vec3& along) {
  const Vec3 whole = squarable(v);
  const Vec3 part = whole - along * along.dot(whole);
  const double square = part.squaredNorm();
  return square > 1e-12 * whole.squaredNorm() ? Vec3(part * (1 / std::sqrt(square)))
                                              : Vec3(Vec3::Zero());
}

Vec3 any_perpendicular(const Vec3& along) {
  int least = 0;
  along.cwiseAbs().minCoeff(&least);
  return along.cross(Vec3::Unit(least)).normalized();
}

// Of the upper bone and of the lower one: both are computed side by side.
using Two = Eigen::Array2d;

struct TwoVectors {
  Two x, y, z;

  TwoVectors(const Two& a, const Two& b, const Two& c) : x(a), y(b), z(c) {}
  TwoVectors(const Vec3& upper, const Vec3& lower)
      : x(upper.x(), lower.x()), y(upper.y(), lower.y()), z(upper.z(), lower.z()) {}

  Vec3 at(int i) const { return {x[i], y[i], z[i]}; }
  Two dot(const TwoVectors& v) const { return x * v.x + y * v.y + z * v.z; }
  Two dot(const Vec3& v) const { return x * v.x() + y * v.y() + z * v.z(); }
  TwoVectors operator*(const Two& by) const { return {x * by, y * by, z * by}; }
};

// The rotation that takes bone and hinge from where they are to where they shall be. The hinge, of
// any length, is squared to the bone where it is; where it shall be it is perpendicular to it.
Quat frame_rotation(const Vec3& bone_from, const Vec3& hinge_from, const Vec3& bone_to,
                    const Vec3& hinge_to) {
  const Vec3 from = perpendicular_part(hinge_from, bone_from);
  if (is_zero(from)) return shortest_arc(bone_from, bone_to);
  const Mat3 turn = bone_to * bone_from.transpose() + hinge_to * from.transpose() +
                    bone_to.cross(hinge_to) * bone_from.cross(from).transpose();
  const Quat rotation = Quat(turn).normalized();
  return rotation.w() < 0 ? Quat(-rotation.coeffs()) : rotation;
}

// Below these the two half turns of frame_rotations() are so near to 180 degrees that rounding
// errors would be magnified. Small, so that random rotations hardly ever take the slower way.
constexpr double kNearlyOpposite = 1e-3, kNearlyHalfTurn = 1e-5;

// frame_rotation() of both bones, by half angles alone: each bone b goes to t by the shortest arc,
// (1 + b.t, b x t), and is then turned about t, by the cosine and sine of what is left between the
// hinge there and where it shall be. All of it is scaled alike, so that one division at the end is
// enough. The arc takes a vector f that is perpendicular to b to f - (b + t) (f.t) / (1 + b.t).
// False where it would not be exact; then nothing is done.
bool frame_rotations(const TwoVectors& b, const Vec3& hinge_from, const TwoVectors& t,
                     const Vec3& hinge_to, Quat& upper, Quat& lower) {
  const Two bent = b.dot(hinge_from);
  const TwoVectors f{hinge_from.x() - b.x * bent, hinge_from.y() - b.y * bent,
                     hinge_from.z() - b.z * bent};
  const Two square = f.dot(f), w = 1 + b.dot(t), ft = f.dot(t);
  const TwoVectors both{b.x + t.x, b.y + t.y, b.z + t.z};
  // What f becomes, times w.
  const TwoVectors hinge{w * f.x - ft * both.x, w * f.y - ft * both.y, w * f.z - ft * both.z};
  const Two length = w * square.sqrt();
  const Two cosine = length + hinge.dot(hinge_to);
  const double least = 1e-12 * hinge_from.squaredNorm();
  if (!(square.minCoeff() > least && w.minCoeff() > kNearlyOpposite &&
        (cosine - kNearlyHalfTurn * length).minCoeff() > 0)) {
    return false;
  }
  const TwoVectors across{hinge_to.y() * t.z - hinge_to.z() * t.y,
                          hinge_to.z() * t.x - hinge_to.x() * t.z,
                          hinge_to.x() * t.y - hinge_to.y() * t.x};
  const Two sine = hinge.dot(across);
  const TwoVectors part{cosine * (b.y * t.z - b.z * t.y) + sine * both.x,
                        cosine * (b.z * t.x - b.x * t.z) + sine * both.y,
                        cosine * (b.x * t.y - b.y * t.x) + sine * both.z};
  const Two scalar = cosine * w;
  const Two scale = 1 / (scalar * scalar + part.dot(part)).sqrt();
  const TwoVectors unit = part * scale;
  const Two first = scalar * scale;
  upper = Quat(first[0], unit.x[0], unit.y[0], unit.z[0]);
  lower = Quat(first[1], unit.x[1], unit.y[1], unit.z[1]);
  return true;
}

// The arc tangent of t, 0 <= t <= tan(pi / 8), within a unit in the last place: its Taylor series,
// economised by Chebyshev polynomials. By powers in groups, which do not wait for one another.
double small_arc_tangent(double t) {
  const double z = t * t, z2 = z * z, z4 = z2 * z2;
  const double low = (-0.3333333333333333 + 0.19999999999995646 * z) +
                     (-0.1428571428469054 + 0.11111111017032477 * z) * z2;
  const double high = (-0.09090904644927628 + 0.0769218463484144 * z) +
                      (-0.06664530458067883 + 0.05858303869105912 * z) * z2;
  const double highest =
      (-0.05086213230646851 + 0.03925249039424092 * z) - 0.01920104962575966 * z2;
  return t + t * z * (low + z4 * (high + z4 * highest));
}

// Twice the angle of the point (cosine, sine), neither negative, at the distance `radius` from the
// origin. Halved twice before the arc tangent is taken, so that nothing depends on its size.
double twice_angle_of(double cosine, double sine, double radius) {
  constexpr double kTiniest = 1e-300;  // the angle of the origin is 0
  const double half = cosine + radius;
  const double quarter = half + std::sqrt(sine * sine + half * half);
  return 8 * small_arc_tangent(sine / (quarter + kTiniest));
}

// two_bone_reach() with the two ends of the usual range known.
double reach_at(double upper_length, double lower_length, double bend) {
  if (bend <= 0) return upper_length + lower_length;
  if (bend >= kPi) return std::abs(upper_length - lower_length);
  return two_bone_reach(upper_length, lower_length, bend);
}

}  // namespace

double soft_distance(double distance, double longest, double softness) {
  const double start = longest - softness;
  if (!(softness > 0) || distance <= start) return distance;
  return start + softness * (1.0 - std::exp(-(distance - start) / softness));
}

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

namespace {

// The bones as they are, unit vectors or zero, and their lengths.
struct Bones {
  TwoVectors unit;
  Two length, inverse;  // 0 the inverse of a bone without length

  explicit Bones(const TwoBoneChain& chain)
      : unit(chain.middle - chain.root, chain.end - chain.middle) {
    const Two square = unit.dot(unit);
    if (square.minCoeff() > 1e-20 && square.maxCoeff() < 1e200) {
      length = square.sqrt();
      inverse = 1 / length;
    } else {
      for (int i = 0; i < 2; ++i) {
        length[i] = length_of(unit.at(i));
        inverse[i] = length[i] > kTiny ? 1 / length[i] : 0;
      }
    }
    unit = unit * inverse;
  }
  Vec3 upper() const { return unit.at(0); }
  Vec3 lower() const { return unit.at(1); }
  double sum() const { return length[0] + length[1]; }
  double difference() const { return length[0] - length[1]; }
};

// The triangle of both bones and the line from root to end.
struct Triangle {
  double distance = 0;        // from root to end
  double bend = 0;            // radians, its exterior angle at the middle
  double along = 0, out = 0;  // of the middle: on the line, and beside it

  Triangle(const Bones& bones, const TwoBoneGoal& goal, double to_target) {
    const double upper = bones.length[0], lower = bones.length[1];
    const double sum = bones.sum(), difference = bones.difference();
    const double max_bend = std::clamp(goal.max_bend, 0.0, kPi);
    const double min_bend = std::clamp(goal.min_bend, 0.0, max_bend);
    const double longest = reach_at(upper, lower, min_bend);
    const double shortest = reach_at(upper, lower, max_bend);
    distance = std::clamp(soft_distance(to_target, longest, goal.softness), shortest, longest);
    // tan^2(bend / 2) = open / folded; both together are 4 upper lower.
    const double open = std::max(0.0, (sum - distance) * (sum + distance));
    const double folded =
        std::max(0.0, (distance - std::abs(difference)) * (distance + std::abs(difference)));
    const double sine = std::sqrt(open), cosine = std::sqrt(folded);
    // Clamped again: an exact limit must not be missed by rounding.
    bend = std::clamp(twice_angle_of(cosine, sine, std::sqrt(open + folded)), min_bend, max_bend);
    if (distance > kTiny * sum) {
      const double inverse = 0.5 / distance;
      // Heron's formula; the law of cosines.
      out = sine * cosine * inverse;
      along = (sum * difference + distance * distance) * inverse;
    } else {
      out = upper;
    }
  }
};

// The line from root to end, unit.
Vec3 line_of(const TwoBoneChain& chain, const Bones& bones, const Vec3& to_target,
             double to_target_length) {
  if (to_target_length > kTiny * bones.sum()) return to_target * (1 / to_target_length);
  const Vec3 line = direction(chain.end - chain.root, bones.sum());
  if (!is_zero(line)) return line;
  return is_zero(bones.upper()) ? bones.lower() : bones.upper();
}

// The way the middle points out, unit.
Vec3 outward_of(const Bones& bones, const Vec3& pole, const Vec3& line, const Vec3& hinge) {
  Vec3 outward = perpendicular_part(pole, line);
  if (!is_zero(outward)) return outward;
  outward =
      perpendicular_part(bones.upper() * bones.length[0] - bones.lower() * bones.length[1], line);
  if (is_zero(outward)) outward = perpendicular_part(line.cross(hinge), line);
  return is_zero(outward) ? any_perpendicular(line) : outward;
}

// The rotations that take the bones to `upper` and `lower`, and the hinge with them.
void turn_bones(const Bones& bones, const Vec3& hinge_now, const Vec3& upper, const Vec3& lower,
                const Vec3& hinge, TwoBoneSolution& solution) {
  const TwoVectors then = TwoVectors(upper, lower) * bones.inverse;
  if (frame_rotations(bones.unit, hinge_now, then, hinge, solution.root_rotation,
                      solution.middle_rotation)) {
    return;
  }
  const auto turn = [&](const Vec3& from, const Vec3& to) {
    if (is_zero(from)) return Quat(Quat::Identity());
    if (is_zero(hinge_now)) return shortest_arc(from, to);
    return frame_rotation(from, hinge_now, to, hinge);
  };
  solution.root_rotation = turn(bones.upper(), then.at(0));
  solution.middle_rotation = turn(bones.lower(), then.at(1));
}

}  // namespace

TwoBoneSolution solve_two_bone(const TwoBoneChain& chain, const TwoBoneGoal& goal) {
  TwoBoneSolution solution;
  solution.middle = chain.middle;
  solution.end = chain.end;
  if (!finite(chain, goal)) return solution;

  const Bones bones(chain);
  if (bones.sum() <= kTiny) {
    solution.reached = (chain.end - goal.target).norm() < 1e-9;
    return solution;
  }
  const Vec3 to_target = goal.target - chain.root;
  const double to_target_length = length_of(to_target);
  const Triangle triangle(bones, goal, to_target_length);
  solution.bend = triangle.bend;

  const Vec3 line = line_of(chain, bones, to_target, to_target_length);
  Vec3 present_hinge = squarable(chain.hinge);
  if (is_zero(present_hinge)) {
    present_hinge = perpendicular_part(bones.upper().cross(bones.lower()), line);
  }
  const Vec3 outward = outward_of(bones, goal.pole, line, present_hinge);
  const Vec3 upper = line * triangle.along + outward * triangle.out;
  const Vec3 reach = line * triangle.distance;
  solution.middle = chain.root + upper;
  solution.end = chain.root + reach;
  solution.reached = (solution.end - goal.target).squaredNorm() < 1e-18;

  turn_bones(bones, present_hinge, upper, reach - upper, outward.cross(line), solution);
  return solution;
}

}  // namespace krok
