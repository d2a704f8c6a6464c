// Takes that are retargeted in blocks. If these fail, the motion of an hour jumps where blocks
// meet, or its report is that of a part.

#include <gtest/gtest.h>

#include "samples/generator/walk.h"
#include "tests/unit/retarget/actors.h"

namespace krok::test {
namespace {

struct BothWays {
  retarget::Retargeted whole, blocks;
};

BothWays retargeted(const Clip& source, const Skeleton& target, int block_frames, int jobs) {
  const RoleMap roles = find_roles(source.skeleton), onto = find_roles(target);
  const Clip resting_target = resting(target);
  BothWays made;
  made.whole = retarget::transfer(source, roles, resting_target, onto, {}).value();
  auto frames = retarget::transfer(frames_of(source), roles, resting_target, onto, {.jobs = jobs},
                                   block_frames)
                    .value();
  made.blocks.clip = load(frames.frames, jobs).value();
  made.blocks.report = *frames.report;
  return made;
}

double largest_angle(const Clip& a, const Clip& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.orientations.size(); ++i) {
    largest = std::max(largest, angle_between(a.orientations[i].cast<double>().normalized(),
                                              b.orientations[i].cast<double>().normalized()));
  }
  return largest;
}

TEST(RetargetInBlocks, IsTheWhole) {
  const Clip walk = samples::make_walk({.steps = 60, .rate = 60}).value().clip;
  const Clip lively = lively_clip(human_skeleton(), 1000);
  for (const Clip* source : {&walk, &lively}) {
    const Skeleton target = with_other_axes(scaled(human_skeleton(), 0.8), 5);
    const auto [whole, blocks] = retargeted(*source, target, 290, 2);
    EXPECT_LT(largest_distance(whole.clip, blocks.clip), 1e-6);
    EXPECT_LT(largest_angle(whole.clip, blocks.clip), 1e-6);
    EXPECT_EQ(whole.report.contacts.size(), blocks.report.contacts.size());
    EXPECT_NEAR(whole.report.largest_shift, blocks.report.largest_shift, 1e-9);
    EXPECT_EQ(whole.report.left_foot->largest_correction_frame,
              blocks.report.left_foot->largest_correction_frame);
    // The same bytes whichever threads ask first.
    const auto again = retargeted(*source, target, 290, 1);
    EXPECT_EQ(largest_distance(again.blocks.clip, blocks.clip), 0);
  }
}

}  // namespace
}  // namespace krok::test
