// A motion that is brought onto the skeleton it was made for is that motion, whatever the joints
// are called there. If these fail, a rename bends knees, and a prop among the joints does.

#include <gtest/gtest.h>

#include "samples/generator/rig.h"
#include "samples/generator/walk.h"
#include "unit/retarget/actors.h"

namespace krok {
namespace {

using namespace test;
using retarget::Method;

// A walk on straight legs, as ragdolls and puppets have it: where a knee's square root of a
// rounding error shows most. `away` metres from the origin, where floats are coarser.
Clip straight_legged(double away) {
  Clip clip = lively_clip(human_skeleton());
  const Skeleton& skeleton = clip.skeleton;
  std::vector<Transform> local(skeleton.names.size()), pose(local.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    world_to_local(skeleton.parents, pose, local);
    local[0].position.x() += away;
    for (const char* knee : {"LeftLeg", "RightLeg"}) {
      local[at(skeleton.find(knee))].orientation = Quat::Identity();
    }
    local_to_world(skeleton.parents, local, pose);
    clip.set_pose(f, pose);
  }
  return clip;
}

std::vector<Clip> motions() {
  std::vector<Clip> clips = {straight_legged(0), straight_legged(20),
                             lively_clip(with_turned_joints(human_skeleton()))};
  samples::WalkOptions options;
  options.steps = 3;
  const auto walk = samples::make_walk(options);
  EXPECT_TRUE(walk.ok());
  for (const auto rig :
       {samples::Rig::hips, samples::Rig::static_root, samples::Rig::ground_root}) {
    clips.push_back(samples::with_rig(walk->clip, rig));
  }
  return clips;
}

Clip renamed(Clip clip) {
  for (std::string& name : clip.skeleton.names) name = "other:" + name;
  return clip;
}

// With one joint more, below the hips, so that it is another skeleton of the same person.
Clip with_holster(const Clip& clip) {
  Clip result;
  result.rate = clip.rate;
  result.skeleton = clip.skeleton;
  const int hips = find_roles(clip.skeleton).joint(Role::hips);
  const Transform offset{Vec3(0.2, 0, 0), Quat::Identity()};
  result.skeleton.add("Holster", hips, clip.skeleton.reference[at(hips)] * offset);
  result.resize(clip.frame_count());
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    pose.resize(clip.skeleton.names.size());
    clip.get_pose(f, pose);
    pose.push_back(pose[at(hips)] * offset);
    result.set_pose(f, pose);
  }
  return result;
}

TEST(OtherNames, ChangeNothing) {
  for (const Clip& clip : motions()) {
    const auto result = transfer(clip, renamed(clip));
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result->report.method, Method::same_skeleton);
    EXPECT_EQ(result->report.scale, 1);
    EXPECT_EQ(largest_distance(result->clip, clip), 0);
  }
}

TEST(OtherNames, WithAnotherJointBesideThemChangeNothingBeyondRounding) {
  const std::vector<Clip> clips = motions();
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const Clip target = renamed(with_holster(clips[i]));
    const auto result = transfer(clips[i], target);
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result->report.method, Method::roles);
    // From the hips down: a root above them stays where the target's reference pose has it.
    double largest = 0;
    for (int f = 0; f < target.frame_count(); ++f) {
      const auto is = result->clip.frame_positions(f), was = target.frame_positions(f);
      for (std::size_t j = at(target.skeleton.find("other:Hips")); j < is.size(); ++j) {
        largest = std::max(largest, double((is[j] - was[j]).norm()));
      }
    }
    EXPECT_LT(largest, i == 1 ? 2e-5 : 2e-6) << i;
  }
}

// Feet that need a correction still get it, without a jump from those that need none: raising the
// floor under a straight leg by ever less moves its knee by ever less.
TEST(OtherNames, CorrectionsOfALegBeginSmoothly) {
  const Clip clip = straight_legged(0);
  double before = 0.1;
  for (const double share : {1e-2, 1e-3, 3e-4, 1e-4, 1e-5}) {
    Clip target = renamed(with_holster(clip));
    for (const char* side : {"other:Left", "other:Right"}) {
      Skeleton& skeleton = target.skeleton;
      for (const char* joint : {"Foot", "ToeBase", "ToeBase_end"}) {
        skeleton.reference[at(skeleton.find(std::string(side) + joint))].position.y() +=
            share * 0.3;
      }
    }
    const auto result = transfer(clip, target, {.scale = 1});
    ASSERT_TRUE(result.ok());
    const double moved = largest_distance(result->clip, with_holster(clip));
    EXPECT_LT(moved, before) << share;
    before = moved;
  }
  EXPECT_LT(before, 1e-5);
}

}  // namespace
}  // namespace krok
