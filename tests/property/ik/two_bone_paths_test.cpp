// A million random paths of targets and poles. If these fail, an elbow or a knee flips, snaps or
// trembles while what it is led by moves by a little.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "support/this_build.h"

namespace krok {
namespace {

const int kPaths = test::sanitized() ? 20'000 : 1'000'000;
constexpr int kSteps = 3;       // of a path
constexpr double kStep = 1e-4;  // of the chain's length, and radians of the pole
constexpr double kAllowed = 1.5;
constexpr double kRounding = 1e-9;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }
  Vec3 direction() {
    const double z = between(-1, 1), angle = between(0, 2 * kPi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937_64 random_;
};

// Bones of these lengths anywhere, bent about a hinge of any length that is not quite square to
// them.
TwoBoneChain random_chain(double upper, double lower, Dice& dice) {
  TwoBoneChain chain;
  const Vec3 along = dice.direction();
  const Vec3 hinge = along.cross(dice.direction()).normalized();
  chain.root = 2 * dice.direction();
  chain.middle = chain.root + upper * along;
  chain.end = chain.middle + lower * (Eigen::AngleAxisd(dice.between(0, 3), hinge) * along);
  chain.hinge = dice.between(0.5, 2) * (hinge + 0.2 * dice.direction());
  return chain;
}

// How fast the exact solution moves with target and pole, by the geometry of its triangle: the
// middle joint is `along` the line to the target and `out` beside it, towards the pole.
struct Rates {
  double distance = 0;  // to the target
  double sine = 0;      // of the angle between line and pole
  double out = 0;
  double middle_away = 0, upper_away = 0, lower_away = 0;  // by the target's distance
  double middle_in = 0;      // by a step of the target in the plane of the limb
  double middle_across = 0;  // across it

  Rates(const TwoBoneChain& chain, const TwoBoneGoal& goal) {
    const double u = (chain.middle - chain.root).norm(), l = (chain.end - chain.middle).norm();
    const Vec3 line = goal.target - chain.root;
    distance = line.norm();
    const double cosine = line.dot(goal.pole) / (distance * goal.pole.norm());
    sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double reach = std::clamp(distance, std::abs(u - l), u + l);
    const double along = (u * u + reach * reach - l * l) / (2 * reach);
    out = std::sqrt(std::max(0.0, u * u - along * along));
    // d = u cos a + l cos b with u sin a = l sin b. A little more, for where a bone is square to
    // the line its rate is zero at one end of a step and not at the other.
    const double more = 20 * kStep * (u + l);
    const bool moves = reach == distance;
    upper_away = moves ? (std::abs(reach - along) + more) / (reach * out) : 0;
    lower_away = moves ? (std::abs(along) + more) / (reach * out) : 0;
    middle_away = u * upper_away;
    middle_in = u / distance;
    middle_across = (std::abs(along) + out * std::abs(cosine) / sine) / distance;
  }
};

// A step of target and pole, split as the rates want it.
struct Step {
  double away = 0, in = 0, across = 0;  // metres
  double pole = 0;                      // radians, out of the plane of line and pole

  Step(const TwoBoneChain& chain, const TwoBoneGoal& before, const TwoBoneGoal& after) {
    const Vec3 line = (before.target - chain.root).normalized();
    const Vec3 out = (before.pole - line * line.dot(before.pole)).normalized();
    const Vec3 side = line.cross(out);
    const Vec3 moved = after.target - before.target;
    away = std::abs(moved.dot(line));
    in = std::abs(moved.dot(out));
    across = std::abs(moved.dot(side));
    pole = std::abs((after.pole - before.pole).dot(side)) / before.pole.norm();
  }
};

// Near these the rates themselves change within a step: the bones in line (stretched or folded), a
// target at the root, a pole along the line to the target.
bool is_degenerate(const Rates& rates, double length) {
  const double step = kStep * length;
  const double fastest = std::max(rates.upper_away, rates.lower_away);
  return 10 * step * fastest * length > rates.out || rates.distance < 20 * step ||
         rates.sine < 20 * (kStep + step / rates.distance);
}

// The bones, from two solutions of one chain.
void expect_near(const TwoBoneSolution& a, const TwoBoneSolution& b, const Rates& rates,
                 const Step& step) {
  const double turns =
      (step.in + step.across / rates.sine) / rates.distance + step.pole / rates.sine;
  ASSERT_LE((b.middle - a.middle).norm(),
            kAllowed * (rates.middle_away * step.away + rates.middle_in * step.in +
                        rates.middle_across * step.across + rates.out * step.pole / rates.sine) +
                kRounding);
  ASSERT_LE(angle_between(a.root_rotation, b.root_rotation),
            kAllowed * (rates.upper_away * step.away + turns) + kRounding);
  ASSERT_LE(angle_between(a.middle_rotation, b.middle_rotation),
            kAllowed * (rates.lower_away * step.away + turns) + kRounding);
}

// Bones of any lengths, targets in reach, out of reach and too near, no softness: the solution
// moves no faster than the exact one does, outside its degenerate places.
TEST(TwoBonePaths, JumpNoFartherThanTheExactSolutionMoves) {
  Dice dice(1);
  long tested = 0, left_out = 0;
  for (int path = 0; path < kPaths; ++path) {
    const double upper = dice.between(0.1, 1), lower = dice.between(0.1, 1), length = upper + lower;
    const TwoBoneChain chain = random_chain(upper, lower, dice);
    TwoBoneGoal goal;
    goal.target = chain.root + dice.between(0, 1.3) * length * dice.direction();
    goal.pole = dice.between(0.5, 2) * dice.direction();
    TwoBoneSolution before = solve_two_bone(chain, goal);
    for (int i = 0; i < kSteps; ++i) {
      const TwoBoneGoal last = goal;
      goal.target += dice.between(0, kStep) * length * dice.direction();
      goal.pole += dice.between(0, kStep) * goal.pole.norm() * dice.direction();
      const TwoBoneSolution after = solve_two_bone(chain, goal);
      const Rates one(chain, last), other(chain, goal);
      // At the reach's two ends the rate falls to zero; the larger one holds.
      const Rates& rates = one.middle_away > other.middle_away ? one : other;
      if (is_degenerate(one, length) || is_degenerate(other, length)) {
        ++left_out;
      } else {
        ++tested;
        ASSERT_LE((after.end - before.end).norm(),
                  kAllowed * std::max(1.0, std::abs(upper - lower) / one.distance) *
                          (goal.target - last.target).norm() +
                      kRounding);
        ASSERT_NO_FATAL_FAILURE(expect_near(before, after, rates, Step(chain, last, goal)))
            << "path " << path;
      }
      before = after;
    }
  }
  EXPECT_LT(left_out, (tested + left_out) / 50) << "almost all must be tested";
}

// Limbs of a body: bones whose lengths differ by a quarter at most, softness of a tenth of the
// limb, the pole a limb's length away and not within 60 degrees of the line, the target at half the
// limb's length or farther, as far as you like. There the middle joint moves by at most 1.5 times
// what target and pole move by, stretched limbs included.
TEST(TwoBonePaths, LimbsJumpByAtMostOneAndAHalfOfTheStep) {
  Dice dice(2);
  double worst = 0;
  for (int path = 0; path < kPaths; ++path) {
    const double ratio = dice.between(0.8, 1.25), length = dice.between(0.3, 1.2);
    const TwoBoneChain chain =
        random_chain(length * ratio / (1 + ratio), length / (1 + ratio), dice);
    const Vec3 line = dice.direction();
    const Vec3 out = line.cross(dice.direction()).normalized();
    const double angle = dice.between(kPi / 3, 2 * kPi / 3);
    TwoBoneGoal goal;
    goal.softness = 0.1 * length;
    goal.target = chain.root + dice.between(0.5, 1.3) * length * line;
    goal.pole = length * (std::cos(angle) * line + std::sin(angle) * out);
    TwoBoneSolution before = solve_two_bone(chain, goal);
    for (int i = 0; i < kSteps; ++i) {
      const Vec3 target = dice.between(0, kStep) * length * dice.direction();
      const Vec3 pole = dice.between(0, kStep) * length * dice.direction();
      goal.target += target;
      goal.pole += pole;
      const TwoBoneSolution after = solve_two_bone(chain, goal);
      const double step = std::hypot(target.norm(), pole.norm());
      const double moved =
          std::max((after.middle - before.middle).norm(), (after.end - before.end).norm());
      ASSERT_LE(moved, kAllowed * step + kRounding) << "path " << path;
      if (step > 0.1 * kStep * length) worst = std::max(worst, moved / step);
      before = after;
    }
  }
  EXPECT_GT(worst, 1) << "the paths do not come where limbs move fastest";
  RecordProperty("worst", std::to_string(worst));
}

}  // namespace
}  // namespace krok
