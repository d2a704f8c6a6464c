// Near singularities. Stretched: goals of the 7-joint arm whose elbow and wrist are bent by 1e-6 to
// 0.1 rad, from the middle of all ranges. In and out of reach: an arm of three free joints follows
// a hand's target that goes out to 1.3 of its length and comes back, frame by frame from the
// solution before; a joint oscillates in a frame in which it turns back from the frame before by
// over half a degree, and in the next one again.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "bench/ik/arms.h"
#include "bench/ik/parts.h"
#include "core/index.h"
#include "math/quaternion.h"

namespace krok::bench {
namespace {

ik::Solver solver_of(const std::vector<int>& parents, const ik::Limits& limits,
                     const Solving& solving, double tolerance, int restarts) {
  ik::Options options;
  options.method = solving.method;
  options.iterations = solving.iterations;
  options.restarts = restarts;
  options.distance = options.angle = tolerance;
  return std::move(*ik::Solver::create(parents, limits, options));
}

void stretched(const Solving& solving) {
  constexpr int kPoses = 2000;
  const Arm arm = lbr_iiwa_14();
  const ArmJoints joints = joints_of(arm);
  ik::Solver solver = solver_of(joints.parents, joints.limits, solving, 1e-5, 150);
  std::mt19937_64 random(4);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  int solved = 0;
  long iterations = 0, starts = 0;
  for (int i = 0; i < kPoses; ++i) {
    std::vector<double> angles;
    for (const Link& link : arm.links) {
      angles.push_back((link.lowest + unit() * (link.highest - link.lowest)) * kRadiansPerDegree);
    }
    for (const std::size_t bent : {3, 5}) angles[bent] = std::pow(10.0, -6 + 5 * unit());
    const Transform wanted = end_of(arm, angles);
    ik::Goal goal;
    goal.kind = ik::Goal::Kind::pose;
    goal.joint = 6;
    goal.point = joints.tip.position;
    goal.target = wanted.position;
    goal.orientation = wanted.orientation * joints.tip.orientation.conjugate();
    std::vector<Transform> pose = joints.middle;
    const auto outcome = solver.solve({&goal, 1}, pose);
    solved += (*outcome)->reached ? 1 : 0;
    iterations += (*outcome)->iterations;
    starts += (*outcome)->starts;
  }
  std::printf("  %-22s stretched: %6.2f %% solved, %.1f iterations from %.2f starts", solving.name,
              100.0 * solved / kPoses, double(iterations) / kPoses, double(starts) / kPoses);
}

void in_and_out(const Solving& solving) {
  constexpr int kPasses = 40, kFrames = 240;
  const std::vector<int> parents = {-1, 0, 1, 2};
  ik::Solver solver = solver_of(parents, {}, solving, 1e-4, 0);
  std::mt19937_64 random(5);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 * 2 - 1; };
  double largest_turn = 0, largest_change = 0, farthest = 0;
  int oscillations = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Transform> pose = {{Vec3::Zero(), Quat::Identity()},
                                   {Vec3(0, 0.3, 0), Quat::Identity()},
                                   {Vec3(0.1, 0.55, 0), Quat::Identity()},
                                   {Vec3(0.1, 0.63, 0), Quat::Identity()}};
    const double length = 0.3 + std::hypot(0.1, 0.25) + 0.08;
    const Vec3 way = Vec3(unit(), unit(), unit()).normalized();
    const Vec3 aside = 0.08 * Vec3(unit(), unit(), unit());
    std::vector<std::vector<Vec3>> turns;
    for (int f = 0; f < kFrames; ++f) {
      ik::Goal goal;
      goal.joint = 3;
      const double reach = 0.9 - 0.4 * std::cos(2 * kPi * f / kFrames);
      goal.target = reach * length * way + aside;
      const std::vector<Transform> before = pose;
      (void)solver.solve({&goal, 1}, pose);
      if (f == 0) continue;
      const double miss = (pose[3].position - goal.target).norm();
      const double least = std::max(0.0, goal.target.norm() - length);
      farthest = std::max(farthest, miss - least);
      turns.emplace_back();
      for (std::size_t j = 0; j < 3; ++j) {
        turns.back().push_back(
            rotation_vector(pose[j].orientation * before[j].orientation.conjugate()));
        largest_turn = std::max(largest_turn, turns.back()[j].norm());
        if (turns.size() < 2) continue;
        const auto& last = turns[turns.size() - 2][j];
        largest_change = std::max(largest_change, (turns.back()[j] - last).norm());
        if (turns.size() < 3) continue;
        const auto& first = turns[turns.size() - 3][j];
        const double small = 0.5 * kRadiansPerDegree;
        const bool back = last.dot(first) < 0 && last.dot(turns.back()[j]) < 0;
        if (back && std::min({first.norm(), last.norm(), turns.back()[j].norm()}) > small) {
          ++oscillations;
        }
      }
    }
  }
  std::printf(
      "; in and out of reach: %d oscillations, largest turn %.2f, change of it %.2f degrees a "
      "frame, misses by %.2f mm more than it must\n",
      oscillations, largest_turn / kRadiansPerDegree, largest_change / kRadiansPerDegree,
      1e3 * farthest);
}

}  // namespace

void near_singular() {
  std::printf("near singularities\n");
  for (const Solving& solving : kSolvings) {
    stretched(solving);
    in_and_out(solving);
  }
}

}  // namespace krok::bench
