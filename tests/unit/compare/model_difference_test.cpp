// If these fail, two models pass for the same that are not, or the other way round.

#include "compare/model_difference.h"

#include <gtest/gtest.h>

#include <limits>

#include "compare/mesh_difference.h"

namespace krok::compare {
namespace {

Model make_model() {
  Model model;
  model.skeleton.add("Root", -1, {});
  model.skeleton.add("Tip", 0, {Vec3(0, 1, 0), Quat::Identity()});
  model.skeleton.add("Side", 0, {Vec3(1, 0, 0), Quat::Identity()});
  model.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  model.normals.assign(4, Vec3f(0, 0, 1));
  model.texture_coordinates = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  model.tangents.assign(4, Vec4f(1, 0, 0, 1));
  model.influences_per_vertex = 2;
  model.influence_joints = {0, 1, 0, 0, 1, 2, 1, 0};
  model.influence_weights = {0.75f, 0.25f, 1, 0, 0.5f, 0.5f, 1, 0};
  model.triangles = {{0, 1, 2}, {0, 2, 3}};
  model.parts = {{"Skin", "Leather", 0, 2}};
  return model;
}

ModelDifference compare(const Model& a, const Model& b) {
  const auto found = difference(a, b, {});
  EXPECT_TRUE(found.ok()) << found.error().message;
  return found.ok() ? *found : ModelDifference();
}

TEST(ModelDifference, ACopyIsTheSame) {
  const ModelDifference found = compare(make_model(), make_model());
  EXPECT_TRUE(found.same());
  EXPECT_EQ(found.positions.count, 4);
  EXPECT_EQ(found.weights.count, 4);
}

TEST(ModelDifference, MeasuresEachAttributeAtItsVertex) {
  Model other = make_model();
  other.positions[2].y() += 1e-4f;
  other.normals[1] = Vec3f(0, std::sin(0.01f), std::cos(0.01f));
  other.texture_coordinates[3].x() += 0.125f;
  other.tangents[0].w() = -1;
  const ModelDifference found = compare(make_model(), other);
  EXPECT_FALSE(found.same());
  EXPECT_NEAR(found.positions.largest, 1e-4, 1e-7);
  EXPECT_EQ(found.positions.where.vertex, 2);
  EXPECT_NEAR(found.normals.largest, 0.01, 1e-6);
  EXPECT_EQ(found.normals.where.vertex, 1);
  EXPECT_EQ(found.texture_coordinates.largest, 0.125);
  EXPECT_EQ(found.texture_coordinates.where.vertex, 3);
  EXPECT_TRUE(found.tangents.within());
  EXPECT_EQ(found.tangent_sides.over, 1);
  EXPECT_EQ(found.tangent_sides.where.vertex, 0);
  EXPECT_TRUE(found.weights.within());

  other = make_model();
  other.tangents[3] = Vec4f(std::cos(0.01f), std::sin(0.01f), 0, 1);
  const ModelDifference turned = compare(make_model(), other);
  EXPECT_FALSE(turned.same());
  EXPECT_NEAR(turned.tangents.largest, 0.01, 1e-6);
  EXPECT_EQ(turned.tangents.where.vertex, 3);
  EXPECT_TRUE(turned.tangent_sides.within());
  other.tangents.clear();
  EXPECT_EQ(compare(make_model(), other).structure,
            std::vector<std::string>{"only the first has tangents"});
}

TEST(ModelDifference, WeightsAreComparedJointByJoint) {
  // Equal weights in another order, and the other skeleton's joints in another order.
  Model other = make_model();
  std::swap(other.skeleton.names[1], other.skeleton.names[2]);
  std::swap(other.skeleton.reference[1], other.skeleton.reference[2]);
  other.influence_joints = {0, 2, 0, 0, 1, 2, 2, 0};
  EXPECT_TRUE(compare(make_model(), other).same());

  other = make_model();
  other.influence_weights = {0.75f, 0.25f, 1, 0, 0.625f, 0.375f, 1, 0};
  const ModelDifference found = compare(make_model(), other);
  EXPECT_EQ(found.weights.largest, 0.125);
  EXPECT_EQ(found.weights.where.vertex, 2);
  EXPECT_EQ(found.weights.where.joint, 1);

  // More places for influences, filled in with nothing.
  other = make_model();
  other.influences_per_vertex = 3;
  other.influence_joints = {0, 1, 0, 0, 0, 0, 1, 2, 0, 1, 0, 0};
  other.influence_weights = {0.75f, 0.25f, 0, 1, 0, 0, 0.5f, 0.5f, 0, 1, 0, 0};
  EXPECT_TRUE(compare(make_model(), other).same());
}

TEST(ModelDifference, SaysWhatDiffersInTopology) {
  Model other = make_model();
  other.positions.pop_back();
  other.normals.pop_back();
  other.texture_coordinates.pop_back();
  other.tangents.pop_back();
  other.influence_joints.resize(6);
  other.influence_weights.resize(6);
  other.triangles[1] = {0, 1, 2};
  ModelDifference found = compare(make_model(), other);
  ASSERT_EQ(found.structure.size(), 1u);
  EXPECT_EQ(found.structure[0], "4 vertices in the first, 3 in the second");

  other = make_model();
  other.triangles[1] = {0, 3, 2};
  found = compare(make_model(), other);
  ASSERT_EQ(found.structure.size(), 1u);
  EXPECT_EQ(found.structure[0],
            "part Skin: triangle 1 is (0, 2, 3) in the first and (0, 3, 2) in the second");

  other = make_model();
  other.parts[0].material = "Iron";
  EXPECT_EQ(compare(make_model(), other).structure.size(), 1u);

  other = make_model();
  other.normals.clear();
  found = compare(make_model(), other);
  ASSERT_EQ(found.structure.size(), 1u);
  EXPECT_EQ(found.structure[0], "only the first has normals");
}

TEST(ModelDifference, ValuesThatAreNotNumbersAreTrouble) {
  Model bad = make_model();
  bad.normals[0].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(difference(bad, make_model(), {}).ok());
}

TEST(TriangleDifference, OrderAndFirstCornerDoNotMatterButWindingDoes) {
  const std::vector<Triangle> list = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  EXPECT_EQ(difference_in_triangles(list, std::vector<Triangle>{{1, 2, 0}, {5, 3, 4}, {6, 7, 8}}),
            "");
  EXPECT_EQ(difference_in_triangles(list, std::vector<Triangle>{{6, 7, 8}, {0, 1, 2}, {3, 4, 5}}),
            "");
  EXPECT_NE(difference_in_triangles(list, std::vector<Triangle>{{0, 2, 1}, {3, 4, 5}, {6, 7, 8}}),
            "");
  EXPECT_EQ(difference_in_triangles(list, std::vector<Triangle>{{0, 1, 2}}),
            "3 triangles in the first, 1 in the second");
  EXPECT_EQ(difference_in_triangles({}, {}), "");
}

}  // namespace
}  // namespace krok::compare
