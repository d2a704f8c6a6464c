// Would fail if the mesh that shows a skeleton were missing, inside out, or not a model that the
// rest of the library takes.

#include "skin/bind.h"

#include <gtest/gtest.h>

#include "support/test_scenes.h"

namespace krok {
namespace {

// Twice the signed volume of all triangles' tetrahedra to the origin, thrice over; its sign tells
// whether the triangles face outwards.
double signed_volume(const Model& model) {
  double sum = 0;
  for (const auto& [a, b, c] : model.triangles) {
    const Vec3 p = model.positions[a].cast<double>(), q = model.positions[b].cast<double>(),
               r = model.positions[c].cast<double>();
    sum += p.dot(q.cross(r)) / 6;
  }
  return sum;
}

TEST(BoneMesh, IsAClosedModelThatFacesOutwards) {
  const Model model = bone_mesh(test::with_turned_joints(test::human_skeleton()));
  EXPECT_TRUE(check(model).ok());
  EXPECT_EQ(model.triangles.size(), 8 * (model.skeleton.names.size() - 1));
  EXPECT_GT(signed_volume(model), 0);
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    const auto& [a, b, c] = model.triangles[t];
    const Vec3f across =
        (model.positions[b] - model.positions[a]).cross(model.positions[c] - model.positions[a]);
    EXPECT_GT(across.dot(model.normals[a]), 0);
    EXPECT_NEAR(model.normals[a].norm(), 1, 1e-5);
  }
}

TEST(BoneMesh, ALoneJointAndBonesWithoutLengthAreShown) {
  Skeleton skeleton;
  const int root = skeleton.add("root", Skeleton::kNoParent, {});
  EXPECT_TRUE(check(bone_mesh(skeleton)).ok());
  EXPECT_EQ(bone_mesh(skeleton).triangles.size(), 8u);
  skeleton.add("same place", root, {});
  EXPECT_EQ(bone_mesh(skeleton).triangles.size(), 8u);
  EXPECT_TRUE(check(bone_mesh(skeleton)).ok());
  skeleton.add("elsewhere", root, {Vec3(0, -1, 0), Quat::Identity()});
  EXPECT_EQ(bone_mesh(skeleton).triangles.size(), 8u);
  EXPECT_GT(signed_volume(bone_mesh(skeleton)), 0);
}

}  // namespace
}  // namespace krok
