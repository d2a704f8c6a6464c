// If these fail, krok-lint finds other faults in a long take than in a short one: at the borders of
// its parts they are missed, come twice, or are cut.

#include "lint/lint.h"

#include <gtest/gtest.h>

#include "core/index.h"
#include "samples/generator/walk.h"

namespace krok::lint_test {
namespace {

constexpr int kPart = 900;  // frames

struct Take {
  Clip clip;
  RoleMap roles;

  Take() {
    samples::WalkOptions options;
    options.steps = 70;
    options.rate = 60;
    options.noise_angle = 0.05 * kRadiansPerDegree;
    auto made = samples::make_walk(options);
    EXPECT_TRUE(made.ok());
    clip = std::move(made->clip);
    roles = find_roles(clip.skeleton);
    EXPECT_GT(clip.frame_count(), 2 * kPart + 300);
  }

  lint::MotionFaults in_parts(const lint::MotionOptions& options = {}) const {
    const auto judge = [&](const Clip& part, const lint::MotionOptions& how) {
      return lint::lint_motion(part, roles, how);
    };
    const std::size_t bytes = kPart * clip.skeleton.names.size() * 28;
    auto found = lint::lint_long_take(frames_of(clip), options, 2, judge, bytes);
    EXPECT_TRUE(found.ok());
    return *std::move(found);
  }

  void expect_the_same(const lint::MotionOptions& options = {}) const {
    const lint::MotionFaults whole = lint::lint_motion(clip, roles, options),
                             found = in_parts(options);
    ASSERT_EQ(found.findings.size(), whole.findings.size());
    for (std::size_t i = 0; i < whole.findings.size(); ++i) {
      const lint::Finding &a = whole.findings[i], &b = found.findings[i];
      SCOPED_TRACE(facts_of(a.rule).id);
      EXPECT_EQ(std::tuple(b.rule, b.kind, b.joint, b.first, b.last, b.worst),
                std::tuple(a.rule, a.kind, a.joint, a.first, a.last, a.worst));
      EXPECT_NEAR(b.value, a.value, 0.1 * a.value);
    }
  }
};

TEST(LintLongTake, FaultsInAndBetweenPartsAreFoundOnce) {
  Take take;
  EXPECT_TRUE(take.in_parts().findings.empty());
  const auto arm = at(take.clip.skeleton.find("LeftForeArm"));
  const Quatf turn(Eigen::AngleAxisf(0.3F, Vec3f::UnitX()));
  for (const int frame : {300, kPart - 1, 2 * kPart, 2 * kPart + 200}) {
    Quatf& spike = take.clip.frame_orientations(frame)[arm];
    spike = spike * turn;
  }
  // Frozen from one part to the next but one.
  for (int f = kPart - 100; f < 2 * kPart - 50; ++f) {
    std::ranges::copy(take.clip.frame_positions(kPart - 100), take.clip.frame_positions(f).begin());
    std::ranges::copy(take.clip.frame_orientations(kPart - 100),
                      take.clip.frame_orientations(f).begin());
  }
  take.expect_the_same();
}

TEST(LintLongTake, WhatIsWrongAllTheTimeIsOneFault) {
  Take take;
  const auto foot = at(take.clip.skeleton.find("LeftFoot"));
  for (int f = 0; f < take.clip.frame_count(); f += 40) {
    take.clip.frame_positions(f)[foot].y() += 0.1F;
  }
  lint::MotionOptions options;
  options.settings.enabled.fill(false);
  options.settings.enabled[at(static_cast<int>(lint::Rule::bone_length))] = true;
  const auto found = take.in_parts(options).findings;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].first, 0);
  EXPECT_EQ(found[0].last, take.clip.frame_count() - 1);
}

TEST(LintLongTake, TheEndsOfALoopAreCompared) {
  Take take;
  const auto arm = at(take.clip.skeleton.find("LeftForeArm"));
  take.clip.frame_orientations(take.clip.frame_count() - 1)[arm] =
      take.clip.frame_orientations(0)[arm] * Quatf(Eigen::AngleAxisf(0.5F, Vec3f::UnitX()));
  lint::MotionOptions options;
  options.is_loop = true;
  options.settings.enabled.fill(false);
  options.settings.enabled[at(static_cast<int>(lint::Rule::loop_seam))] = true;
  take.expect_the_same(options);
}

}  // namespace
}  // namespace krok::lint_test
