// If these fail, characters whose limbs end at elbows and knees, as blocky ones of games, take no
// captures, stand beside their feet, or get joints that their mesh does not have.

#include "retarget/limb_ends.h"

#include <gtest/gtest.h>

#include "retarget/retarget.h"
#include "roles/roles.h"
#include "samples/generator/walk.h"
#include "tests/unit/retarget/actors.h"

namespace krok::retarget {
namespace {

using test::at;

// A body of boxes: each hangs on a joint and reaches from there to `end`.
class Blocks {
 public:
  Blocks() {
    const int hips = add("hips", -1, {0, 0.8, 0}, {0, 1, 0});
    const int chest = add("chest", hips, {0, 1, 0}, {0, 1.3, 0});
    add("head", chest, {0, 1.35, 0}, {0, 1.7, 0});
    for (const bool left : {true, false}) {
      const double side = left ? 1 : -1;
      const std::string letter = left ? ".L" : ".R";
      const int arm =
          add("arm_upper" + letter, chest, {side * 0.25, 1.25, 0}, {side * 0.5, 1.25, 0});
      add("arm_lower" + letter, arm, {side * 0.5, 1.25, 0}, {side * 0.75, 1.25, 0});
      const int leg = add("leg_upper" + letter, hips, {side * 0.12, 0.8, 0}, {side * 0.12, 0.4, 0});
      add("leg_lower" + letter, leg, {side * 0.12, 0.4, 0}, {side * 0.12, 0, 0});
    }
  }

  Model model;

  int add(const std::string& name, int parent, const Vec3& from, const Vec3& to) {
    const int joint = model.skeleton.add(name, parent, {from, Quat::Identity()});
    const Vec3 along = (to - from).normalized(), across = along.unitOrthogonal(),
               third = along.cross(across);
    for (const Vec3& end : {from, to}) {
      for (const double a : {-0.08, 0.08}) {
        for (const double b : {-0.08, 0.08}) {
          model.positions.push_back((end + a * across + b * third).cast<float>());
          model.influence_joints.insert(model.influence_joints.end(),
                                        {static_cast<std::uint16_t>(joint), 0, 0, 0});
          model.influence_weights.insert(model.influence_weights.end(), {1, 0, 0, 0});
        }
      }
    }
    return joint;
  }
};

// Rigs whose feet hang on the root, as goals of inverse kinematics: shoes stayed behind, 19.5 cm
// apart in each frame of any motion.
TEST(LimbEnds, FeetThatHangElsewhereGoWithTheLegs) {
  Model model = Blocks().model;
  for (const double side : {1.0, -1.0}) {
    const std::string letter = side > 0 ? ".L" : ".R";
    const int foot =
        model.skeleton.add("foot" + letter, 0, {{side * 0.12, 0.08, 0}, Quat::Identity()});
    model.skeleton.add("sole" + letter, foot, {{side * 0.12, 0, 0.1}, Quat::Identity()});
  }
  const Skeleton with_ends = with_limb_ends(model);
  ASSERT_EQ(with_ends.joint_count(), model.skeleton.joint_count() + 4);
  const auto walk = samples::make_walk({});
  ASSERT_TRUE(walk.ok());
  const auto made = test::transfer(walk->clip, with_ends, {});
  ASSERT_TRUE(made.ok());
  const Clip clip = without_last_joints(made->clip, 4);
  ASSERT_EQ(clip.skeleton.names, model.skeleton.names);
  const auto apart = [&](int frame, const char* a, const char* b) {
    const auto places = clip.frame_positions(frame);
    return (places[at(clip.skeleton.find(a))] - places[at(clip.skeleton.find(b))]).norm();
  };
  float nearest = 1e9F, farthest = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    EXPECT_NEAR(apart(f, "leg_lower.L", "foot.L"), 0.32, 1e-4);
    EXPECT_NEAR(apart(f, "foot.R", "sole.R"), std::hypot(0.08, 0.1), 1e-4);
    nearest = std::min(nearest, apart(f, "foot.L", "foot.R"));
    farthest = std::max(farthest, apart(f, "foot.L", "foot.R"));
  }
  EXPECT_GT(farthest - nearest, 0.2F);
  // A foot that is elsewhere, as a spare part beside the body, is none of the leg's.
  for (const char* foot : {"foot.L", "foot.R"}) {
    model.skeleton.reference[at(model.skeleton.find(foot))].position = Vec3(3, 0, 0);
  }
  const Skeleton apart_from_it = with_limb_ends(model);
  EXPECT_LT((apart_from_it.reference[at(apart_from_it.find("leg_lower.L_end"))].position -
             Vec3(0.12, 0, 0))
                .norm(),
            1e-6);
}

// Tips of such shoes went 8 cm into the ground at toe-off, and the report had them at 0.
TEST(LimbEnds, ShoesThatHangElsewhereStayAboveTheGround) {
  Blocks blocks;
  Model& model = blocks.model;
  std::vector<int> shoes;
  for (const double side : {1.0, -1.0}) {
    const std::string letter = side > 0 ? ".L" : ".R";
    const Vec3 heel(side * 0.12, 0.05, -0.05);
    shoes.push_back(blocks.add("foot" + letter, 0, heel, heel + Vec3(0, 0, 0.3)));
    model.skeleton.reference[at(shoes.back())].position = {side * 0.12, 0.08, 0};
  }
  double floor = 0;
  for (const Vec3f& vertex : model.positions) floor = std::min<double>(floor, vertex.y());
  const Skeleton with_ends = with_limb_ends(model);
  const auto walk = samples::make_walk({});
  ASSERT_TRUE(walk.ok());
  const auto points = points_of_feet(model, with_ends, find_roles(with_ends));
  const auto deepest = [&](const Retargeted& made) {
    const Clip clip = without_last_joints(made.clip, 4);
    double lowest = 0;
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      const int joint = model.influence_joints[4 * v];
      if (std::ranges::find(shoes, joint) == shoes.end()) continue;
      const Vec3 place =
          model.skeleton.reference[at(joint)].inverse() * model.positions[v].cast<double>();
      for (int f = 0; f < clip.frame_count(); ++f) {
        const Vec3 moved = clip.frame_positions(f)[at(joint)].cast<double>() +
                           clip.frame_orientations(f)[at(joint)].cast<double>() * place;
        lowest = std::min(lowest, moved.y() - made.report.floor);
      }
    }
    return lowest;
  };
  const auto sunk = test::transfer(walk->clip, with_ends, {.target_floor = floor});
  const auto made =
      test::transfer(walk->clip, with_ends, {.target_floor = floor, .target_feet = points});
  ASSERT_TRUE(sunk.ok() && made.ok());
  EXPECT_LT(deepest(*sunk), -0.05);
  EXPECT_GT(deepest(*made), -0.02);
}

TEST(LimbEnds, AreWhereTheMeshEnds) {
  Model model = Blocks().model;
  ASSERT_FALSE(find_roles(model.skeleton).humanoid);
  const Skeleton with_ends = with_limb_ends(model);
  ASSERT_EQ(with_ends.joint_count(), model.skeleton.joint_count() + 4);
  EXPECT_TRUE(find_roles(with_ends).humanoid);
  const auto place = [&](const char* name) {
    return with_ends.reference[at(with_ends.find(name))].position;
  };
  EXPECT_LT((place("leg_lower.L_end") - Vec3(0.12, 0, 0)).norm(), 1e-6);
  EXPECT_LT((place("arm_lower.R_end") - Vec3(-0.75, 1.25, 0)).norm(), 1e-6);
  // A shoe that points forwards does not tilt the shank.
  const std::size_t knee = at(model.skeleton.find("leg_lower.L"));
  for (int v = 0; v < 8; ++v) {
    model.positions.push_back({0.12F, v < 4 ? 0.16F : 0.0F, v < 4 ? 0.0F : 0.2F});
    model.influence_joints.insert(model.influence_joints.end(),
                                  {static_cast<std::uint16_t>(knee), 0, 0, 0});
    model.influence_weights.insert(model.influence_weights.end(), {1, 0, 0, 0});
  }
  const Skeleton shod = with_limb_ends(model);
  EXPECT_NEAR(shod.reference[at(shod.find("leg_lower.L_end"))].position.z(), 0, 1e-6);
  // Without a mesh nothing is known, and a skeleton that has hands and feet keeps them.
  model.positions.clear();
  EXPECT_EQ(with_limb_ends(model).names, model.skeleton.names);
  Model human;
  human.skeleton = test::human_skeleton(1.8);
  EXPECT_EQ(with_limb_ends(human).names, human.skeleton.names);
}

TEST(LimbEnds, TakeAWalkAndAreLeftOutOfIt) {
  const Model model = Blocks().model;
  samples::WalkOptions options;
  options.steps = 6;
  const auto walk = samples::make_walk(options);
  ASSERT_TRUE(walk.ok());
  Clip target;
  target.skeleton = with_limb_ends(model);
  const int added = target.skeleton.joint_count() - model.skeleton.joint_count();
  Options how;
  how.target_floor = 0;
  const auto moved = transfer(walk->clip, find_roles(walk->clip.skeleton), target,
                              find_roles(target.skeleton), how);
  ASSERT_TRUE(moved.ok()) << moved.error().message;
  const int end = target.skeleton.find("leg_lower.L_end");
  double lowest = 1, highest = 0;
  for (int f = 0; f < moved->clip.frame_count(); ++f) {
    const double height = moved->clip.frame_positions(f)[at(end)].y();
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  EXPECT_NEAR(lowest, 0, 0.02) << "the sole comes to the ground";
  EXPECT_GT(highest, 0.05) << "and leaves it";
  const Clip kept = without_last_joints(moved->clip, added);
  EXPECT_EQ(kept.skeleton.names, model.skeleton.names);
  ASSERT_EQ(kept.frame_count(), moved->clip.frame_count());
  for (int f = 0; f < kept.frame_count(); ++f) {
    for (std::size_t j = 0; j < kept.skeleton.names.size(); ++j) {
      EXPECT_EQ(kept.frame_positions(f)[j], moved->clip.frame_positions(f)[j]);
      EXPECT_EQ(kept.frame_orientations(f)[j].coeffs(),
                moved->clip.frame_orientations(f)[j].coeffs());
    }
  }
  std::vector<Contact> contacts(1);
  contacts[0].joint = end;
  give_to_parents(target.skeleton, added, contacts);
  EXPECT_EQ(contacts[0].joint, target.skeleton.find("leg_lower.L"));
}

}  // namespace
}  // namespace krok::retarget
