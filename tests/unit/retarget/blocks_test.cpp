// Takes that are retargeted in blocks. If these fail, the motion of an hour jumps where blocks
// meet, or its report is that of a part.

#include <gtest/gtest.h>

#include <algorithm>

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

// The clip with the pose of its frame `begin` held up to `end`, turned onto its back if it lies.
Clip with_pause(Clip clip, int begin, int end, bool lies) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(begin, pose);
  if (lies) {
    const Quat turn = from_rotation_vector(Vec3(-kPi / 2, 0, 0));
    const Vec3 root = pose[0].position;
    double lowest = root.y();
    for (Transform& joint : pose) {
      joint = {Vec3(root + turn * (joint.position - root)), turn * joint.orientation};
      lowest = std::min(lowest, joint.position.y());
    }
    for (Transform& joint : pose) joint.position.y() += 0.03 - lowest;
  }
  for (int f = begin; f < end; ++f) clip.set_pose(f, pose);
  return clip;
}

TEST(RetargetInBlocks, IsTheWhole) {
  const Clip walk = samples::make_walk({.steps = 60, .rate = 60}).value().clip;
  const Clip lively = lively_clip(human_skeleton(), 1000);
  // What is touched for longer than a block and its neighbours' overlap.
  const Clip stop = with_pause(walk, 400, 1300, false), rest = with_pause(lively, 200, 900, true);
  for (const Clip* source : {&walk, &lively, &stop, &rest}) {
    const Skeleton target = with_other_axes(scaled(human_skeleton(), 0.8), 5);
    const BothWays made = retargeted(*source, target, 190, 2);
    EXPECT_LT(largest_distance(made.whole.clip, made.blocks.clip), 1e-6);
    EXPECT_TRUE(made.whole.clip.orientations == made.blocks.clip.orientations);
    const retarget::Report &whole = made.whole.report, &blocks = made.blocks.report;
    EXPECT_NEAR(whole.largest_shift, blocks.largest_shift, 1e-9);
    EXPECT_EQ(whole.left_foot->largest_correction_frame,
              blocks.left_foot->largest_correction_frame);
    ASSERT_EQ(whole.contacts.size(), blocks.contacts.size());
    for (std::size_t i = 0; i < whole.contacts.size(); ++i) {
      const retarget::ContactReport &a = whole.contacts[i], &b = blocks.contacts[i];
      EXPECT_EQ(a.part + a.on, b.part + b.on);
      EXPECT_EQ(a.start, b.start);
      EXPECT_EQ(a.end, b.end);
      EXPECT_NEAR(a.slide, b.slide, 1e-6);
      EXPECT_NEAR(a.height, b.height, 1e-6);
    }
    // The same bytes whichever threads ask first.
    const BothWays again = retargeted(*source, target, 190, 1);
    EXPECT_EQ(largest_distance(again.blocks.clip, made.blocks.clip), 0);
  }
  const auto touches = retargeted(rest, with_other_axes(human_skeleton(), 5), 190, 1).whole.report;
  const auto is_long = [](const retarget::ContactReport& contact) {
    return contact.part == "right hand" && contact.end - contact.start > 20;
  };
  EXPECT_TRUE(std::ranges::any_of(touches.contacts, is_long));
}

}  // namespace
}  // namespace krok::test
