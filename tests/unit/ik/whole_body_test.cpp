// Would fail if what stays in place while goals move a body were a part of what they have to move.

#include "ik/whole_body.h"

#include <gtest/gtest.h>

namespace krok::ik {
namespace {

// A trunk with two legs of one joint each, and an arm that hangs down to a hand of three fingers,
// whose tips are as near to the ground as the feet.
Skeleton creature() {
  Skeleton skeleton;
  skeleton.add("a", -1, {Vec3(0, 1, 0)});
  skeleton.add("foot one", 0, {Vec3(0.2, 0, 0)});
  skeleton.add("foot two", 0, {Vec3(-0.2, 0, 0)});
  const int chest = skeleton.add("b", 0, {Vec3(0, 1.5, 0)});
  const int upper = skeleton.add("c", chest, {Vec3(0.4, 1.4, 0)});
  const int lower = skeleton.add("d", upper, {Vec3(0.5, 0.8, 0)});
  for (const double z : {-0.1, 0.0, 0.1}) {
    const int palm = skeleton.add("palm" + std::to_string(z), lower, {Vec3(0.5, 0.4, z)});
    skeleton.add("tip" + std::to_string(z), palm, {Vec3(0.5, 0.1, z)});
  }
  return skeleton;
}

TEST(WholeBody, FingersBesideAGoalAreNotHeldAsFeetAre) {
  Clip clip;
  clip.skeleton = creature();
  clip.resize(1);
  clip.set_pose(0, clip.skeleton.reference);
  const auto held = [&](const char* name) {
    KeyedGoal goal;
    goal.goal.joint = clip.skeleton.find(name);
    std::vector<std::string> names;
    for (const HeldFoot& end : ends_on_ground(clip, {&goal, 1})) {
      names.push_back(clip.skeleton.names[static_cast<std::size_t>(end.foot)]);
    }
    return names;
  };
  const std::vector<std::string> feet = {"foot one", "foot two"};
  EXPECT_EQ(held("palm0.000000"), feet);
  // A goal of the trunk moves neither hand nor feet.
  EXPECT_EQ(held("b"), feet) << "what hangs on the goal's joint is moved";
}

}  // namespace
}  // namespace krok::ik
