// Would fail if a model were moved by the wrong joints because its skeleton lists them in another
// order, or if a model that cannot follow a motion were accepted.

#include "skin/bind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "motion/sample.h"
#include "support/linear_blend.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// The skeleton with the last subtree first: another order that still has parents before children.
Skeleton reordered(const Skeleton& skeleton) {
  Skeleton result;
  std::vector<int> place(skeleton.names.size(), -1);
  const auto children = skeleton.children();
  const auto visit = [&](const auto& self, int joint, int parent) -> void {
    place[joint] = result.add(skeleton.names[joint], parent, skeleton.reference[joint],
                              skeleton.end_sites[joint] != 0);
    for (auto child = children[joint].rbegin(); child != children[joint].rend(); ++child) {
      self(self, *child, place[joint]);
    }
  };
  visit(visit, 0, Skeleton::kNoParent);
  return result;
}

std::vector<Vec3f> skin(const Model& model, const Clip& clip, int frame) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(frame, pose);
  std::vector<SkinMatrix> palette(pose.size());
  make_palette(inverse_reference(model.skeleton), pose, palette);
  std::vector<Vec3f> positions(model.positions.size()), normals(model.normals.size());
  test::linear_blend(palette, test::skin_vertices(model), {positions, normals});
  return positions;
}

TEST(BindTo, AnotherOrderOfJointsMovesVerticesAlike) {
  const Skeleton skeleton = test::with_turned_joints(test::human_skeleton());
  const Skeleton other = reordered(skeleton);
  ASSERT_NE(skeleton.names, other.names);
  ASSERT_TRUE(check(other).ok());
  const Clip clip = test::swinging_clip(skeleton, 4, 10);
  const auto same = bind_to(test::tube_model(skeleton), clip.skeleton);
  // The same mesh, its joints named by their places in the other skeleton.
  Model moved = test::tube_model(skeleton);
  for (auto& joint : moved.influence_joints) {
    joint = static_cast<std::uint16_t>(other.find(skeleton.names[joint]));
  }
  moved.skeleton = other;
  const auto bound = bind_to(moved, clip.skeleton);
  ASSERT_TRUE(same.ok() && bound.ok());
  EXPECT_EQ(bound->skeleton.names, skeleton.names);
  EXPECT_EQ(bound->skeleton.parents, skeleton.parents);
  const auto a = skin(*same, clip, 3), b = skin(*bound, clip, 3);
  for (std::size_t v = 0; v < a.size(); ++v) EXPECT_LT((a[v] - b[v]).norm(), 1e-6f);
}

TEST(BindTo, JointsWithoutVerticesMayBeMissing) {
  const Skeleton skeleton = test::human_skeleton();
  Model model = test::tube_model(skeleton, 1);
  Skeleton motion = skeleton;
  motion.names[motion.find("Head_end")] = "Nub";
  const auto bound = bind_to(model, motion);
  ASSERT_TRUE(bound.ok());
  EXPECT_EQ(bound->skeleton.names, motion.names);
  // The joint that only the motion has stands where its parent carries it.
  const int nub = motion.find("Nub");
  EXPECT_LT((bound->skeleton.reference[nub].position - skeleton.reference[nub].position).norm(),
            1e-12);
}

TEST(BindTo, AMissingJointThatMovesVerticesIsNamed) {
  const Skeleton skeleton = test::human_skeleton();
  Skeleton motion = skeleton;
  motion.names[motion.find("LeftArm")] = "arm.L";
  const auto bound = bind_to(test::tube_model(skeleton), motion);
  ASSERT_FALSE(bound.ok());
  EXPECT_EQ(bound.error().code, "skin-joint-missing");
  EXPECT_THAT(bound.error().message, HasSubstr("LeftArm"));
}

TEST(ReferenceDifferences, AnyPoseOfTheSkeletonWillDo) {
  const Skeleton skeleton = test::with_turned_joints(test::human_skeleton());
  const Clip clip = test::swinging_clip(skeleton, 4, 3);
  EXPECT_THAT(reference_differences(skeleton, clip), IsEmpty());
  Skeleton posed = skeleton;
  clip.get_pose(2, posed.reference);
  EXPECT_THAT(reference_differences(posed, clip), IsEmpty());
}

TEST(ReferenceDifferences, APlaceThatTheJointTakesInSomeFrameWillDo) {
  Clip clip = test::swinging_clip(test::human_skeleton(), 4, 3);
  const int head = clip.skeleton.find("Head_end");
  clip.frame_positions(3)[head].y() += 0.05f;
  Skeleton posed = clip.skeleton;
  clip.get_pose(3, posed.reference);
  EXPECT_THAT(reference_differences(posed, clip), IsEmpty());
  clip = cut(clip, 0, 2);
  EXPECT_THAT(reference_differences(posed, clip), SizeIs(1));
}

TEST(ReferenceDifferences, OtherProportionsAndOtherFramesAreTold) {
  const Skeleton skeleton = test::human_skeleton();
  const Clip clip = test::swinging_clip(skeleton, 4, 3);
  const auto taller = reference_differences(test::human_skeleton(1.9), clip);
  ASSERT_THAT(taller, SizeIs(1));
  EXPECT_EQ(taller[0].code, "skin-proportions");
  const auto turned = reference_differences(test::with_turned_joints(skeleton), clip);
  ASSERT_THAT(turned, SizeIs(1));
  EXPECT_EQ(turned[0].code, "skin-reference");
}

TEST(NormalizeInfluences, MergesSortsAndSumsToOne) {
  Model model;
  model.skeleton = test::human_skeleton();
  model.influences_per_vertex = 4;
  model.positions.resize(3);
  model.influence_joints = {5, 2, 5, 9, 1, 2, 3, 4, 8, 7, 6, 5};
  model.influence_weights = {0.2f, 0.1f, 0.2f, 0.0f, -1.0f, 0, 0, 0, 0.25f, 0.25f, 0.25f, 0.25f};
  normalize_influences(model);
  EXPECT_THAT(model.influence_joints, ElementsAre(5, 2, 0, 0, 0, 0, 0, 0, 5, 6, 7, 8));
  EXPECT_FLOAT_EQ(model.influence_weights[0], 0.8f);
  EXPECT_FLOAT_EQ(model.influence_weights[1], 0.2f);
  EXPECT_EQ(model.influence_weights[4], 1.0f);
  for (int v = 0; v < 3; ++v) {
    const float* weights = &model.influence_weights[static_cast<std::size_t>(4 * v)];
    EXPECT_NEAR(std::accumulate(weights, weights + 4, 0.0), 1.0, 1e-7);
  }
  Model again = model;
  normalize_influences(again);
  EXPECT_EQ(again.influence_joints, model.influence_joints);
}

}  // namespace
}  // namespace krok
