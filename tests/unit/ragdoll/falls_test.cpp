// If these fail, figures explode, come apart, sink into the ground or never lie still; or the same
// fall is another one the next time.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "math/quaternion.h"
#include "motion/sample.h"
#include "ragdoll/simulate.h"
#include "samples/generator/walk.h"
#include "support/human_skeleton.h"

namespace krok::ragdoll {
namespace {

struct Walker {
  Clip clip;
  RoleMap roles;
  std::vector<Body> bodies;
  ik::Limits limits;
};

Walker make_walker() {
  samples::WalkOptions options;
  options.steps = 6;
  options.rate = 60;
  Walker walker;
  walker.clip = samples::make_walk(options)->clip;
  walker.roles = find_roles(walker.clip.skeleton);
  walker.bodies = *make_bodies(walker.clip.skeleton, walker.roles);
  walker.limits = ik::anatomical_limits(walker.clip.skeleton, walker.roles);
  return walker;
}

FallOptions on_the_ground(double begin, double duration) {
  FallOptions options;
  options.at = begin;
  options.duration = duration;
  options.surroundings.level = true;
  return options;
}

Fall fall_of(const Walker& walker, const FallOptions& options) {
  auto fall = simulate_fall(walker.clip, walker.roles, walker.bodies, walker.limits, options);
  EXPECT_TRUE(fall.ok()) << fall.error().message;
  return std::move(*fall);
}

// The mean of [0, 1), the same on every machine.
double share(std::mt19937& random) {
  return random() / 4294967296.0;
}

TEST(RagdollFalls, RandomPushesEndInRest) {
  const Walker walker = make_walker();
  std::mt19937 random(7);
  constexpr int kFalls = 60;
  int at_rest = 0, joined = 0, above = 0, within = 0;
  double gap = 0, depth = 0, excess = 0;
  for (int i = 0; i < kFalls; ++i) {
    FallOptions options = on_the_ground(walker.clip.duration() * share(random), 5);
    Push push;
    push.body = static_cast<int>(share(random) * static_cast<double>(walker.bodies.size()));
    const double mass = walker.bodies[at(push.body)].mass;
    const double angle = 2 * kPi * share(random);
    push.impulse = mass * (1 + 7 * share(random)) * Vec3(std::cos(angle), 0.2, std::sin(angle));
    push.time = options.at;
    options.pushes = {push};
    const Fall fall = fall_of(walker, options);
    ASSERT_TRUE(check(fall.clip).ok()) << i;
    at_rest += fall.rest >= 0 ? 1 : 0;
    joined += fall.largest.joint_gap < 1e-3 ? 1 : 0;
    above += fall.largest.penetration < 0.005 ? 1 : 0;
    within += fall.largest.limit_excess < kRadiansPerDegree ? 1 : 0;
    gap = std::max(gap, fall.largest.joint_gap);
    depth = std::max(depth, fall.largest.penetration);
    excess = std::max(excess, fall.largest.limit_excess);
    // Nothing hovers: at the end some joint is near the ground, and none far above it.
    double top = 0;
    for (const Vec3f& place : fall.clip.frame_positions(fall.clip.frame_count() - 1)) {
      top = std::max(top, static_cast<double>(place.y()));
    }
    EXPECT_LT(top, 1.0) << i;
  }
  RecordProperty("figures", std::to_string(gap) + " " + std::to_string(depth));
  EXPECT_GE(at_rest, 59) << at_rest;
  EXPECT_EQ(joined, kFalls) << gap;
  EXPECT_EQ(above, kFalls) << depth;
  EXPECT_EQ(within, kFalls) << excess / kRadiansPerDegree;
  printf("rest %d gap %g depth %g excess %g\n", at_rest, gap, depth, excess / kRadiansPerDegree);
}

}  // namespace
}  // namespace krok::ragdoll
