// If these fail, a scene that a damaged or hostile file leads to crashes the import, hangs it, or
// comes out as a clip or model that breaks what their headers promise.

#include <gtest/gtest.h>

#include <random>

#include "character/mesh.h"
#include "character/motion.h"
#include "character/space.h"
#include "scenes.h"

namespace krok::test {
namespace {

using namespace character;

// Imports all there is; whatever comes out must be sound.
void survive(const nodes::Scene& scene) {
  const auto evaluator = nodes::Evaluator::create(scene);
  if (!evaluator) return;
  Diagnostics found;
  auto joints = choose_joints(scene, *evaluator, "", found);
  if (!joints) return;
  auto rig = make_rig(scene, *evaluator, std::move(*joints), found);
  if (!rig) {
    EXPECT_EQ(rig.error().code, "scene-value");
    return;
  }
  const auto conventions = find_conventions(scene.space, &*rig, find_roles(rig->skeleton), {}, {});
  const auto conversion = Conversion::make(conventions);
  ASSERT_TRUE(conversion.ok());
  const auto actor = make_actor(scene, *evaluator, *rig, *conversion, {.with_morphs = true}, found);
  if (actor) {
    EXPECT_TRUE(check(actor->model).ok()) << check(actor->model).error().message;
    EXPECT_TRUE(check(actor->morphs).ok());
  } else {
    EXPECT_EQ(actor.error().code.substr(0, 6), "scene-") << actor.error().code;
  }
  for (std::size_t a = 0; a < scene.animations.size(); ++a) {
    SamplingOptions options;
    options.rate = 5;
    const auto sampling = choose_sampling(scene.animations[a], options, found);
    if (!sampling) continue;
    const auto clip = make_clip(*evaluator, *rig, *conversion, static_cast<int>(a),
                                sampling->sampling, 1, nullptr, found);
    if (!clip) continue;
    EXPECT_TRUE(check(*clip).ok()) << check(*clip).error().message;
  }
}

TEST(HostileScenes, NodesWithoutSize) {
  for (const std::size_t node : {0, 1, 2, 3, 4}) {
    for (const Vec3& scale : {Vec3(0, 0, 0), Vec3(0, 1, 1), Vec3(1e-200, 1e-200, 1e-200),
                              Vec3(1e200, 1, 1), Vec3(-1, 1, 1), Vec3(1e30, 1e30, 1e30)}) {
      nodes::Scene scene = armature_scene();
      scene.nodes[node].scale = scale;
      survive(scene);
    }
  }
}

TEST(HostileScenes, InverseBindMatricesThatHaveNoInverse) {
  for (const double value : {0.0, 1.0, 1e-300, 1e300, -1.0}) {
    nodes::Scene scene = armature_scene();
    for (Mat4& bind : scene.skins[0].inverse_binds) bind.topRows<3>().setConstant(value);
    survive(scene);
    scene = armature_scene();
    scene.skins[0].inverse_binds[1].topRows<3>().setConstant(value);
    survive(scene);
  }
}

TEST(HostileScenes, RandomMatrices) {
  std::mt19937 random(11);
  const auto number = [&] {
    const double mantissa = static_cast<double>(random() % 2001) / 1000 - 1;
    return mantissa * std::pow(10.0, static_cast<int>(random() % 20) - 10);
  };
  for (int round = 0; round < 300; ++round) {
    nodes::Scene scene = armature_scene();
    nodes::Node& node = scene.nodes[random() % 5];
    node.has_matrix = true;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) node.matrix(r, c) = number();
    }
    Mat4& bind = scene.skins[0].inverse_binds[random() % 3];
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) bind(r, c) = number();
    }
    survive(scene);
  }
}

TEST(HostileScenes, EmptyMeshesAndVerticesFarAway) {
  nodes::Scene scene = armature_scene();
  nodes::Primitive& shape = scene.meshes[0].primitives[0];
  shape.positions = shared(std::vector<Vec3f>(12, Vec3f::Constant(3e38f)));
  survive(scene);
  shape.normals = shared(std::vector<Vec3f>(12, Vec3f::Zero()));
  survive(scene);
  shape = nodes::Primitive();
  shape.positions = shared(std::vector<Vec3f>());
  survive(scene);
  scene.meshes[0].primitives.clear();
  survive(scene);
}

TEST(HostileScenes, SixtyThousandJoints) {
  for (const bool chain : {true, false}) {
    nodes::Scene scene;
    scene.space = {1.0, Quat::Identity()};
    std::vector<int> joints{add_node(scene, "joint", -1)};
    for (int i = 1; i < 60'000; ++i) {
      joints.push_back(add_node(scene, "joint", chain ? i - 1 : 0, Vec3(0.001, 0, 0)));
    }
    nodes::Skin skin;
    skin.joints = joints;
    skin.inverse_binds.assign(joints.size(), Mat4::Identity());
    scene.skins.push_back(skin);
    add_mesh(scene, "Mesh", -1, 0);
    nodes::Animation animation;
    add_channel(animation, 5, nodes::Path::translation, 3, {0, 0.5f}, {0, 0, 0, 1, 0, 0});
    scene.animations.push_back(animation);
    survive(scene);
  }
  nodes::Scene scene;
  for (int i = 0; i < 70'000; ++i) add_node(scene, "joint", -1);
  const auto evaluator = *nodes::Evaluator::create(scene);
  Diagnostics found;
  const auto joints = choose_joints(scene, evaluator, "", found);
  ASSERT_FALSE(joints.ok());
  EXPECT_EQ(joints.error().code, "scene-joints");
}

TEST(HostileScenes, TargetsOutOfProportion) {
  nodes::Scene scene = armature_scene();
  add_mesh(scene, "Large", -1, 0, 3, 20'000);
  nodes::Primitive& small = scene.meshes[0].primitives[0];
  for (int t = 0; t < 4000; ++t) small.targets.push_back({std::to_string(t), nullptr, nullptr});
  scene.meshes[0].weights.assign(4000, 0.0);
  const auto evaluator = *nodes::Evaluator::create(scene);
  Diagnostics found;
  auto rig = make_rig(scene, evaluator, *choose_joints(scene, evaluator, "", found), found);
  const auto actor = make_actor(scene, evaluator, *rig, Conversion(), {.with_morphs = true}, found);
  ASSERT_FALSE(actor.ok());
  EXPECT_EQ(actor.error().code, "scene-morphs");
}

}  // namespace
}  // namespace krok::test
