// Would fail if twist joints moved a mesh at rest, shared out another angle than their part, jumped
// at half a turn, or kept less volume than the closed formula says.

#include "skin/twist_joints.h"

#include <cmath>

#include "samples/candy_wrapper/forearm.h"
#include "scene/mesh_volume.h"
#include "skin/bind.h"
#include "skinned.h"

namespace krok::test {
namespace {

double volume(const Model& model, const std::vector<Vec3f>& positions) {
  std::vector<Vec3> places;
  for (const Vec3f& p : positions) places.push_back(p.cast<double>());
  return mesh_volume(places, model.triangles).volume;
}

// A forearm along +X whose vertices follow the elbow up to the wrist, as one bone's.
Model one_bone_arm() {
  Model model = samples::make_forearm();
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const bool hand = model.positions[v].x() > samples::kForearmLength;
    model.influence_joints[2 * v] = hand ? 1 : 0;
    model.influence_joints[2 * v + 1] = 0;
    model.influence_weights[2 * v] = 1;
    model.influence_weights[2 * v + 1] = 0;
  }
  return model;
}

Clip twisted(const Model& model, std::initializer_list<double> degrees, const Vec3& swing = {}) {
  Clip clip;
  clip.skeleton = samples::make_forearm().skeleton;
  clip.resize(static_cast<int>(degrees.size()));
  int frame = 0;
  for (const double angle : degrees) {
    auto pose = model.skeleton.reference;
    pose.resize(2);
    pose[1].orientation = from_rotation_vector(swing) *
                          from_rotation_vector(Vec3(angle * kRadiansPerDegree, 0, 0)) *
                          pose[1].orientation;
    clip.set_pose(frame++, pose);
  }
  return clip;
}

TEST(TwistJoints, AreAddedWithWeightsAlongTheBoneAndKeepTheMeshAtRest) {
  Model model = one_bone_arm();
  const TwistBone bones[] = {{0, 3, false}};
  ASSERT_TRUE(add_twist_joints(model, bones));
  ASSERT_TRUE(check(model)) << check(model).error().message;
  ASSERT_EQ(model.skeleton.joint_count(), 5);
  EXPECT_EQ(model.skeleton.names[2], "elbow_twist1");
  EXPECT_EQ(model.skeleton.parents[4], 0);
  EXPECT_NEAR((model.skeleton.reference[3].position - model.skeleton.reference[0].position).x(),
              samples::kForearmLength / 2, 1e-12);
  const Skinned rest = skinned(model, SkinMethod::linear, model.skeleton.reference);
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    EXPECT_LT((rest.positions[v] - model.positions[v]).norm(), 1e-6f);
  }
  EXPECT_FALSE(add_twist_joints(model, bones));  // twice
  const TwistBone of_no_length[] = {{1, 1, false}};
  EXPECT_EQ(add_twist_joints(model, of_no_length).error().code, "twist-joints");
}

TEST(TwistJoints, TurnByTheirShareOfTheTwistWhateverTheSwing) {
  Model model = one_bone_arm();
  const TwistBone bones[] = {{0, 3, false}};
  ASSERT_TRUE(add_twist_joints(model, bones));
  Clip clip = twisted(model, {0, 100, -60}, Vec3(0, 0.7, -0.4));
  Stretches none;
  carry_twist_joints(model.skeleton, clip, none);
  ASSERT_TRUE(check(clip)) << check(clip).error().message;
  const double degrees[] = {0, 100, -60};
  for (int frame = 0; frame < 3; ++frame) {
    std::vector<Transform> pose(5);
    clip.get_pose(frame, pose);
    for (int k = 1; k <= 3; ++k) {
      const Quat expected =
          from_rotation_vector(Vec3(degrees[frame] * kRadiansPerDegree * k / 4, 0, 0));
      EXPECT_LT(angle_between(expected, pose[static_cast<std::size_t>(1 + k)].orientation), 1e-6);
    }
  }
}

TEST(TwistJoints, OfTheStartTakeBackTheirShareOfTheJointsOwnTwist) {
  Model model = samples::make_forearm();
  model.skeleton.parents = {-1, 0};
  model.skeleton.add("hand", 1,
                     model.skeleton.reference[1] * Transform{Vec3(0.1, 0, 0), {1, 0, 0, 0}});
  const TwistBone bones[] = {{1, 1, true}};
  ASSERT_TRUE(add_twist_joints(model, bones));
  EXPECT_EQ(model.skeleton.names[3], "wrist_untwist1");
  Clip clip;
  clip.skeleton = model.skeleton;
  for (auto* list : {&clip.skeleton.names}) list->pop_back();
  clip.skeleton.parents.pop_back();
  clip.skeleton.end_sites.pop_back();
  clip.skeleton.reference.pop_back();
  clip.resize(1);
  auto pose = clip.skeleton.reference;
  const Quat turn = from_rotation_vector(Vec3(0, 0, 0.8)) * from_rotation_vector(Vec3(1.4, 0, 0));
  for (std::size_t j : {1u, 2u}) {
    pose[j] = {turn * (pose[j].position - pose[1].position) + model.skeleton.reference[1].position,
               turn * pose[j].orientation};
  }
  clip.set_pose(0, pose);
  Stretches none;
  carry_twist_joints(model.skeleton, clip, none);
  const Quat half = from_rotation_vector(Vec3(0, 0, 0.8)) * from_rotation_vector(Vec3(0.7, 0, 0));
  EXPECT_LT(angle_between(half, clip.frame_orientations(0)[3].cast<double>()), 1e-6);
}

TEST(TwistJoints, GoOnOverHalfATurn) {
  Model model = one_bone_arm();
  const TwistBone bones[] = {{0, 1, false}};
  ASSERT_TRUE(add_twist_joints(model, bones));
  Clip clip = twisted(model, {0, 90, 170, 190, 270, 350});
  Stretches stretches(12);
  stretches[0].xx = 2;
  carry_twist_joints(model.skeleton, clip, stretches);
  ASSERT_EQ(stretches.size(), 18u);
  EXPECT_EQ(stretches[2].xx, 2);  // that of the bone
  const double halves[] = {0, 45, 85, 95, 135, 175};
  for (int frame = 0; frame < 6; ++frame) {
    const Quat expected = from_rotation_vector(Vec3(halves[frame] * kRadiansPerDegree, 0, 0));
    EXPECT_LT(angle_between(expected, clip.frame_orientations(frame)[2].cast<double>()), 1e-6);
  }
}

// With n joints a twist of 150 degrees is shared out in n + 1 parts, of which the wrist, whose
// weights step here, has one: n parts between joints lose (1 - cos(part)) / 3 of their length each.
TEST(TwistJoints, KeepTheVolumeOfTheClosedFormula) {
  for (const int count : {1, 2, 4}) {
    Model model = one_bone_arm();
    const TwistBone bones[] = {{0, count, false}};
    ASSERT_TRUE(add_twist_joints(model, bones));
    Clip clip = twisted(model, {150});
    Stretches none;
    carry_twist_joints(model.skeleton, clip, none);
    auto bound = bind_to(model, clip.skeleton);
    ASSERT_TRUE(bound) << bound.error().message;
    std::vector<Transform> pose(clip.skeleton.names.size());
    clip.get_pose(0, pose);
    const Skinned found = skinned(*bound, SkinMethod::linear, pose);
    const double part = 150.0 / (count + 1) * kRadiansPerDegree;
    const double whole = samples::kForearmLength * samples::kForearmHeight *
                         samples::kForearmWidth * samples::kForearmSides / 2 *
                         std::sin(2 * kPi / samples::kForearmSides);
    const double expected = whole * count / (count + 1) * (1 - std::cos(part)) / 3;
    const double lost = volume(model, model.positions) - volume(model, found.positions);
    EXPECT_NEAR(lost, expected, 0.03 * whole) << count;
    EXPECT_TRUE(count < 4 || lost < 0.05 * whole) << lost / whole;
  }
}

}  // namespace
}  // namespace krok::test
