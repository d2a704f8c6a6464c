// If these fail, glTF scenes are evaluated to something else than viewers show, and comparing a rig
// with its baked motion means nothing.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "formats/gltf/gltf_reader.h"
#include "math/quaternion.h"
#include "nodes/evaluate.h"
#include "support/glb_builder.h"

namespace krok {
namespace {

using test::GlbBuilder;
using Json = nlohmann::ordered_json;

struct Played {
  nodes::Scene asset;
  nodes::Evaluation state;
};

Played play(const GlbBuilder& builder, int animation, double time) {
  Played played;
  played.state.with_tangents = true;
  auto asset = gltf::read(builder.glb());
  EXPECT_TRUE(asset.ok()) << asset.error().message;
  played.asset = std::move(*asset);
  const auto evaluator = nodes::Evaluator::create(played.asset);
  EXPECT_TRUE(evaluator.ok());
  evaluator->evaluate(animation, time, played.state);
  return played;
}

void expect_near(const Vec3& value, const Vec3& expected, double tolerance = 1e-6) {
  EXPECT_LT((value - expected).norm(), tolerance)
      << value.transpose() << " instead of " << expected.transpose();
}

// Corner 2 of the rig stands one metre beside Tip, which turns by 90 degrees in a second.
Vec3 corner(double degrees) {
  const double angle = degrees * kRadiansPerDegree;
  return {std::cos(angle), 1 + std::sin(angle), 0};
}

TEST(GltfEvaluate, SkinsARigAlongItsKeysAndBetween) {
  // Between keys at 0, 45 and 90 degrees the arc is followed; outside the ends hold.
  for (const auto& [time, degrees] : {std::pair{-1.0, 0.0},
                                      {0.0, 0.0},
                                      {0.25, 22.5},
                                      {0.5, 45.0},
                                      {0.9, 81.0},
                                      {1.0, 90.0},
                                      {7.0, 90.0}}) {
    const Played played = play(test::rig(), 0, time);
    expect_near(played.state.positions.at(0)[2], corner(degrees));
    expect_near(played.state.positions.at(0)[0], Vec3(0, 0, 0));
    expect_near(played.state.normals.at(0)[2], Vec3(0, 0, 1));
  }
}

TEST(GltfEvaluate, WithoutAnAnimationNodesStandAsTheFileHasThem) {
  expect_near(play(test::rig(), -1, 0.7).state.positions.at(0)[2], Vec3(1, 1, 0));
}

TEST(GltfEvaluate, TheNodeOfASkinnedMeshDoesNotMoveIt) {
  GlbBuilder builder = test::rig();
  builder.json["nodes"][0]["translation"] = {5, 5, 5};
  expect_near(play(builder, 0, 1).state.positions.at(0)[2], corner(90));
}

TEST(GltfEvaluate, BlendsEightInfluences) {
  GlbBuilder builder = test::rig();
  Json& attributes = builder.json["meshes"][0]["primitives"][0]["attributes"];
  std::vector<std::uint8_t> joints(16, 0);
  std::vector<float> weights(16, 0.0f);
  for (std::size_t i = 0; i < 16; ++i) joints[i] = i % 2 == 0 ? 1 : 0;
  for (float& weight : weights) weight = 0.125f;
  for (const char* set : {"0", "1"}) {
    attributes[std::string("JOINTS_") + set] = builder.add(joints, "VEC4");
    attributes[std::string("WEIGHTS_") + set] = builder.add(weights, "VEC4");
  }
  // Half of each joint.
  expect_near(play(builder, 0, 1).state.positions.at(0)[2], 0.5 * (Vec3(1, 1, 0) + corner(90)));
}

TEST(GltfEvaluate, HoldsStepKeysUntilTheNext) {
  GlbBuilder builder = test::rig();
  builder.json["animations"][0]["samplers"][0]["interpolation"] = "STEP";
  expect_near(play(builder, 0, 0.499).state.positions.at(0)[2], corner(0));
  expect_near(play(builder, 0, 0.5).state.positions.at(0)[2], corner(45));
  expect_near(play(builder, 0, 0.999).state.positions.at(0)[2], corner(45));
}

TEST(GltfEvaluate, FollowsCubicSplines) {
  GlbBuilder builder = test::square();
  // x(t) = t^3 on [0, 2]: values 0 and 8, tangents 0 and 12. y, z = 1.
  const int times = builder.add(std::vector<float>{0, 2}, "SCALAR");
  const int values = builder.add(
      std::vector<float>{9, 9, 9, 0, 1, 1, 0, 0, 0, 12, 0, 0, 8, 1, 1, 9, 9, 9}, "VEC3");
  builder.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", values}, {"interpolation", "CUBICSPLINE"}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  for (const double t : {0.0, 0.3, 1.0, 1.7, 2.0}) {
    expect_near(play(builder, 0, t).state.positions.at(0)[0], Vec3(t * t * t, 1, 1), 1e-12);
  }
}

TEST(GltfEvaluate, RotationsTakeTheShorterArcWhateverTheSigns) {
  GlbBuilder builder = test::rig();
  const float eighth = 0.38268343f, cosine = 0.92387953f, quarter = 0.70710678f;
  builder.json["animations"][0]["samplers"][0]["output"] = builder.add(
      std::vector<float>{0, 0, 0, -1, 0, 0, eighth, cosine, 0, 0, -quarter, -quarter}, "VEC4");
  expect_near(play(builder, 0, 0.25).state.positions.at(0)[2], corner(22.5));
  expect_near(play(builder, 0, 0.75).state.positions.at(0)[2], corner(67.5));
}

TEST(GltfEvaluate, AddsMorphTargetsByTheirWeights) {
  expect_near(play(test::baked_rig(), 0, 0.5).state.positions.at(0)[2], corner(45));
  expect_near(play(test::baked_rig(), 0, 1).state.positions.at(0)[2], corner(90));
  expect_near(play(test::baked_rig(), 0, 0.75).state.positions.at(0)[2],
              0.5 * (corner(45) + corner(90)));
  // The mesh's own weights, and a node's that come before them.
  GlbBuilder builder = test::baked_rig();
  builder.json["meshes"][0]["weights"] = {0, 1};
  expect_near(play(builder, -1, 0).state.positions.at(0)[2], corner(90));
  builder.json["nodes"][0]["weights"] = {1, 0};
  expect_near(play(builder, -1, 0).state.positions.at(0)[2], corner(45));
}

TEST(GltfEvaluate, MultipliesNodesDownTheTree) {
  GlbBuilder builder = test::square();
  builder.json["nodes"][0]["scale"] = {2, 3, 4};
  builder.json["nodes"].push_back(
      {{"children", {0}}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}});
  builder.json["scenes"][0]["nodes"] = nlohmann::json::array({1});
  const Played played = play(builder, -1, 0);
  // (1, 1, 0) scaled is (2, 3, 0), a quarter turn about Z makes it (-3, 2, 0).
  expect_near(played.state.positions.at(0)[2], Vec3(7, 22, 30), 1e-12);
  expect_near(played.state.normals.at(0)[2], Vec3(0, 0, 1), 1e-12);
}

TEST(GltfEvaluate, NormalsStayPerpendicularUnderUnevenAndMirroringScales) {
  GlbBuilder builder = test::square();
  const float half = 0.70710678f;
  builder.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = builder.add(
      std::vector<float>{half, half, 0, half, half, 0, half, half, 0, half, half, 0}, "VEC3");
  builder.json["nodes"][0]["scale"] = {-2, 1, 1};
  // The plane x + y = 0 becomes -x / 2 + y = 0.
  expect_near(play(builder, -1, 0).state.normals.at(0)[0], Vec3(-1, 2, 0).normalized());
}

TEST(GltfEvaluate, NormalsComeOutUnitWhateverTheirLengthInTheFile) {
  GlbBuilder builder = test::square();
  const std::vector<float> lengths = {1.000003F, 0.999996F, 3e-30F, 0};
  const auto view = builder.json["accessors"][1]["bufferView"].get<std::size_t>();
  const auto offset = builder.json["bufferViews"][view]["byteOffset"].get<std::size_t>();
  for (std::size_t v = 0; v < 4; ++v) {
    const float normal[3] = {0, 0.6F * lengths[v], 0.8F * lengths[v]};
    std::memcpy(builder.bin.data() + offset + 12 * v, normal, sizeof normal);
  }
  const Played played = play(builder, -1, 0);
  for (std::size_t v = 0; v < 3; ++v) {
    const Vec3& normal = played.state.normals.at(0)[v];
    EXPECT_NEAR(normal.norm(), 1, 1e-15) << v;
    expect_near(normal, Vec3(0, 0.6, 0.8), 1e-6);
  }
  EXPECT_EQ(played.state.normals.at(0)[3], Vec3::Zero());
}

// Tangents along +X, on either side.
void add_tangents(GlbBuilder& builder) {
  builder.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] =
      builder.add(std::vector<float>{1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1, 1, 0, 0, -1}, "VEC4");
}

void expect_tangent(const Vec4& tangent, const Vec3& direction, double side) {
  expect_near(tangent.head<3>(), direction);
  EXPECT_EQ(tangent.w(), side);
}

TEST(GltfEvaluate, TangentsFollowJoints) {
  GlbBuilder builder = test::rig();
  add_tangents(builder);
  const Played played = play(builder, 0, 1);
  expect_tangent(played.state.tangents.at(0)[1], Vec3(1, 0, 0), -1);
  expect_tangent(played.state.tangents.at(0)[2], Vec3(0, 1, 0), 1);
  expect_tangent(played.state.tangents.at(0)[3], Vec3(0, 1, 0), -1);
}

TEST(GltfEvaluate, TangentsAreMadeOnlyWhereTheyAreWanted) {
  GlbBuilder builder = test::rig();
  add_tangents(builder);
  Played played = play(builder, 0, 1);
  EXPECT_EQ(played.state.tangents.at(0).size(), 4u);
  played.state.with_tangents = false;
  nodes::Evaluator::create(played.asset)->evaluate(0, 1, played.state);
  EXPECT_TRUE(played.state.tangents.at(0).empty());
  EXPECT_TRUE(play(test::rig(), 0, 1).state.tangents.at(0).empty());
}

TEST(GltfEvaluate, TangentsFollowSurfacesAndTurnRoundInAMirror) {
  GlbBuilder builder = test::square();
  builder.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = builder.add(
      std::vector<float>{0.6F, 0.8F, 0, 1, 0.6F, 0.8F, 0, -1, 1, 0, 0, 1, 0, 0, 0, 1}, "VEC4");
  builder.json["nodes"][0]["scale"] = {-2, 1, 1};
  const Played played = play(builder, -1, 0);
  // Unlike normals they are stretched with the surface.
  expect_tangent(played.state.tangents.at(0)[0], Vec3(-1.2, 0.8, 0).normalized(), -1);
  expect_tangent(played.state.tangents.at(0)[1], Vec3(-1.2, 0.8, 0).normalized(), 1);
  expect_tangent(played.state.tangents.at(0)[2], Vec3(-1, 0, 0), -1);
  EXPECT_EQ(played.state.tangents.at(0)[3].head<3>(), Vec3::Zero());  // not NaN
}

TEST(GltfEvaluate, MorphTargetsMoveTangents) {
  GlbBuilder builder = test::baked_rig();
  add_tangents(builder);
  builder.json["meshes"][0]["primitives"][0]["targets"][1]["TANGENT"] =
      builder.add(std::vector<float>{0, 0, 0, 0, 0, 0, -1, 1, 0, -1, 0, 0}, "VEC3");
  const Played played = play(builder, 0, 1);
  expect_tangent(played.state.tangents.at(0)[0], Vec3(1, 0, 0), 1);
  expect_tangent(played.state.tangents.at(0)[2], Vec3(0, 1, 0), 1);
  EXPECT_EQ(played.state.tangents.at(0)[3].head<3>(), Vec3::Zero());
  expect_tangent(play(builder, 0, 0.75).state.tangents.at(0)[2], Vec3(1, 1, 0).normalized(), 1);
}

TEST(GltfEvaluate, AnimatedNodesGivenByAMatrixKeepWhatIsNotAnimated) {
  GlbBuilder builder = test::square();
  builder.json["nodes"][0]["matrix"] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1};
  const int times = builder.add(std::vector<float>{0}, "SCALAR");
  const int values = builder.add(std::vector<float>{5, 0, 0}, "VEC3");
  builder.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", values}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  expect_near(play(builder, 0, 0).state.positions.at(0)[2], Vec3(7, 2, 0), 1e-12);
}

TEST(GltfEvaluate, ShowsAMeshAtEachOfItsNodesOfTheSceneOnly) {
  GlbBuilder builder = test::square();
  builder.json["nodes"].push_back({{"mesh", 0}, {"translation", {4, 0, 0}}});
  builder.json["nodes"].push_back({{"mesh", 0}});
  builder.json["scenes"][0]["nodes"] = {1, 0};
  const Played played = play(builder, -1, 0);
  ASSERT_EQ(played.state.positions.size(), 2u);
  expect_near(played.state.positions[0][0], Vec3(4, 0, 0));
}

TEST(GltfEvaluate, FindsJointsWithTheirNearestJointAbove) {
  GlbBuilder builder = test::rig();
  builder.json["nodes"][1]["children"] = nlohmann::json::array({3});
  builder.json["nodes"].push_back({{"name", "Between"}, {"children", {2}}});
  const auto asset = gltf::read(builder.glb());
  ASSERT_TRUE(asset.ok());
  const auto evaluator = nodes::Evaluator::create(*asset);
  ASSERT_TRUE(evaluator.ok());
  EXPECT_EQ(evaluator->joints(), (std::vector<int>{1, 2}));
  EXPECT_EQ(evaluator->joint_parents(), (std::vector<int>{-1, 0}));
  EXPECT_EQ(evaluator->key_times(0), (std::vector<double>{0, 0.5, 1}));
}

TEST(GltfEvaluate, RigidPartIsTheNearestRotation) {
  const Quat turn = from_rotation_vector(Vec3(0.3, -1.2, 0.8));
  const auto matrix = [&](const Vec3& scale) {
    Mat4 m = Mat4::Identity();
    m.topLeftCorner<3, 3>() = turn.toRotationMatrix() * scale.asDiagonal();
    m.topRightCorner<3, 1>() = Vec3(1, 2, 3);
    return m;
  };
  for (const Vec3& scale : {Vec3(1, 1, 1), Vec3(1e-3, 1, 1e3), Vec3(2, 2, 0)}) {
    const Transform rigid = nodes::rigid_part(matrix(scale));
    EXPECT_LT(angle_between(rigid.orientation, turn), 1e-6) << scale.transpose();
    expect_near(rigid.position, Vec3(1, 2, 3));
  }
  const Transform none = nodes::rigid_part(matrix(Vec3::Zero()));
  EXPECT_NEAR(none.orientation.norm(), 1.0, 1e-12);
  const Transform mirrored = nodes::rigid_part(matrix(Vec3(-1, -1, -1)));
  EXPECT_LT(angle_between(mirrored.orientation, turn), 1e-6);
}

}  // namespace
}  // namespace krok
