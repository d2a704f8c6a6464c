// If these fail, an imported character moves otherwise than its file says: the model skinned by the
// clip does not stand where the file's own nodes and skins put its vertices. The evaluator that
// these are held against shows what three.js shows (see the tests of gltf_reader).

#include <gtest/gtest.h>

#include <algorithm>

#include "character/mesh.h"
#include "character/motion.h"
#include "character/space.h"
#include "scenes.h"
#include "skin/palette.h"
#include "support/linear_blend.h"

namespace krok::test {
namespace {

using namespace character;

struct Imported {
  Rig rig;
  Conversion conversion;
  SceneActor actor;
  Clip clip;
  Stretches stretches;
  Sampling sampling;
  Diagnostics diagnostics;
};

Imported import(const nodes::Scene& scene, const nodes::Evaluator& evaluator, int animation = 0,
                const GivenConventions& given = {}) {
  Imported result;
  Diagnostics& found = result.diagnostics;
  auto joints = choose_joints(scene, evaluator, "", found);
  EXPECT_TRUE(joints.ok());
  auto rig = make_rig(scene, evaluator, std::move(*joints), found);
  EXPECT_TRUE(rig.ok()) << (rig.ok() ? "" : rig.error().message);
  result.rig = std::move(*rig);
  const Conventions conventions =
      find_conventions(scene.space, &result.rig, find_roles(result.rig.skeleton), {}, given);
  result.conversion = *Conversion::make(conventions);
  auto actor =
      make_actor(scene, evaluator, result.rig, result.conversion, {.with_morphs = true}, found);
  EXPECT_TRUE(actor.ok()) << (actor.ok() ? "" : actor.error().message);
  result.actor = std::move(*actor);
  const auto& keys = scene.animations[static_cast<std::size_t>(animation)];
  result.sampling = choose_sampling(keys, {}, found)->sampling;
  auto clip = make_clip(evaluator, result.rig, result.conversion, animation, result.sampling, 1,
                        nullptr, found, &result.stretches);
  EXPECT_TRUE(clip.ok());
  result.clip = std::move(*clip);
  EXPECT_TRUE(check(result.clip).ok()) << check(result.clip).error().message;
  EXPECT_TRUE(check(result.stretches, result.clip).ok());
  EXPECT_TRUE(check(result.actor.model).ok()) << check(result.actor.model).error().message;
  return result;
}

// The largest distance between the skinned model and what the evaluator shows; `to_krok` is applied
// to the latter.
double farthest(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                const Imported& imported, const Mat4& to_krok = Mat4::Identity()) {
  const Model& model = imported.actor.model;
  const auto reference_to_joint = inverse_reference(model.skeleton);
  std::vector<SkinMatrix> palette(reference_to_joint.size());
  std::vector<Transform> pose(reference_to_joint.size());
  std::vector<Vec3f> positions(model.positions.size()), normals(model.normals.size());
  nodes::Evaluation state;
  double worst = 0;
  (void)scene;
  for (int frame = 0; frame < imported.clip.frame_count(); ++frame) {
    imported.clip.get_pose(frame, pose);
    for (std::size_t j = 0; j < palette.size(); ++j) {
      const std::size_t i = static_cast<std::size_t>(frame) * palette.size() + j;
      const Stretch stretch = imported.stretches.empty() ? Stretch() : imported.stretches[i];
      palette[j] = skin_matrix(reference_to_joint[j], pose[j], stretch);
    }
    linear_blend_parallel(palette, skin_vertices(model), {positions, normals}, 1);
    evaluator.evaluate(0, imported.sampling.time(frame), state);
    std::size_t v = 0;
    for (const auto& instance : state.positions) {
      for (const Vec3& shown : instance) {
        const Vec3 wanted = (to_krok * shown.homogeneous()).head<3>();
        worst = std::max(worst, (positions[v++].cast<double>() - wanted).norm());
      }
    }
    EXPECT_EQ(v, positions.size());
  }
  return worst;
}

TEST(ImportedShape, AScaledArmatureIsFolded) {
  const nodes::Scene scene = armature_scene();
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  EXPECT_EQ(imported.clip.frame_count(), 13);
  EXPECT_LT(farthest(scene, evaluator, imported), 2e-6);
  EXPECT_FALSE(has_code(imported.diagnostics, "scene-scale"));
  // The bones are those of the nodes, in metres: 30 cm from hips to spine.
  const Skeleton& skeleton = imported.clip.skeleton;
  ASSERT_EQ(skeleton.names, (std::vector<std::string>{"Hips", "Spine", "Head", "Head_end"}));
  EXPECT_NEAR((skeleton.reference[1].position - skeleton.reference[0].position).norm(), 0.3, 1e-9);
  EXPECT_EQ(skeleton.end_sites[3], 1);
}

// The scene with two keys of a cubic spline on Head_end's rotation: in-tangent, value, out-tangent.
nodes::Scene with_end_spline(const std::vector<float>& values) {
  nodes::Scene scene = armature_scene();
  EXPECT_EQ(scene.nodes[4].name, "Head_end");
  add_channel(scene.animations[0], 4, nodes::Path::rotation, 4, {0, 0.5f}, values);
  scene.animations[0].channels.back().interpolation = nodes::Interpolation::cubic_spline;
  return scene;
}

// A comparison of all numbers would take a still end to move: tangents are 0, the value is not.
TEST(ImportedShape, AStillEndStaysOneUnderACubicSpline) {
  std::vector<float> values = {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0,
                               0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
  const nodes::Scene still = with_end_spline(values);
  EXPECT_EQ(import(still, *nodes::Evaluator::create(still)).clip.skeleton.end_sites[3], 1);
  values[8] = 0.5f;  // leaves the first key turning
  const nodes::Scene moving = with_end_spline(values);
  EXPECT_EQ(import(moving, *nodes::Evaluator::create(moving)).clip.skeleton.end_sites[3], 0);
}

TEST(ImportedShape, TheBindPoseIsTheReferenceAndTheMotionStaysTheSame) {
  nodes::Scene scene = armature_scene();
  const auto before = *nodes::Evaluator::create(scene);
  const Imported bound = import(scene, before);
  // The same file saved in another pose.
  scene.nodes[1].rotation = scene.nodes[1].rotation * from_rotation_vector(Vec3(0.4, 0, 0.1));
  scene.nodes[3].rotation = from_rotation_vector(Vec3(0, 1.2, 0));
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported posed = import(scene, evaluator);
  EXPECT_LT(farthest(scene, evaluator, posed), 2e-6);
  EXPECT_TRUE(has_code(posed.diagnostics, "scene-pose"));
  // A face whose eyes are elsewhere, not turned, was 14 mm off without a word.
  nodes::Scene moved = armature_scene();
  moved.nodes[3].translation.x() += 0.1;
  EXPECT_TRUE(has_code(import(moved, *nodes::Evaluator::create(moved)).diagnostics, "scene-pose"));
  EXPECT_FALSE(has_code(bound.diagnostics, "scene-pose"));
  for (std::size_t j = 1; j < 3; ++j) {
    const Transform a = bound.rig.skeleton.reference_local(static_cast<int>(j));
    const Transform b = posed.rig.skeleton.reference_local(static_cast<int>(j));
    EXPECT_LT((a.position - b.position).norm(), 1e-9);
    EXPECT_LT(angle_between(a.orientation, b.orientation), 1e-7);
  }
}

TEST(ImportedShape, UnitAndAxesThatTheUserGives) {
  nodes::Scene scene = armature_scene();
  scene.nodes[0].scale = Vec3::Ones();
  scene.nodes[0].rotation = Quat::Identity();  // z up now, and centimetres
  scene.skins.clear();
  scene.meshes.clear();
  scene.nodes.pop_back();
  scene.roots.pop_back();
  const int skin = add_skin(scene, "Body", {1, 2, 3});
  add_mesh(scene, "Body", -1, skin);
  const auto evaluator = *nodes::Evaluator::create(scene);
  GivenConventions given;
  given.unit = *parse_unit("cm");
  given.up = Direction::plus_z;
  given.forward = Direction::minus_y;
  const Imported imported = import(scene, evaluator, 0, given);
  Mat4 to_krok = Mat4::Identity();
  to_krok.topLeftCorner<3, 3>() =
      0.01 * rotation_to_krok(Direction::plus_z, Direction::minus_y)->toRotationMatrix();
  EXPECT_LT(farthest(scene, evaluator, imported, to_krok), 2e-6);
  EXPECT_NEAR(imported.clip.skeleton.reference[0].position.y(), 0.9, 1e-9);
}

// A mesh with two materials, as exporters and krok-skin write it: what goes by the vertices'
// numbers (morph targets, point caches) would fit no more if each part got vertices of its own.
TEST(ImportedShape, PartsOfOneMeshShareTheirVertices) {
  nodes::Scene scene = armature_scene();
  const auto whole = import(scene, *nodes::Evaluator::create(scene)).actor.model;
  for (nodes::Mesh& mesh : scene.meshes) {
    nodes::Primitive second = mesh.primitives[0];
    auto& triangles = mesh.primitives[0].triangles;
    second.triangles.assign(triangles.begin() + 4, triangles.end());
    second.material = "other";
    triangles.resize(4);
    mesh.primitives.push_back(second);
  }
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Model parted = import(scene, evaluator).actor.model;
  EXPECT_EQ(parted.positions, whole.positions);
  EXPECT_EQ(parted.normals, whole.normals);
  EXPECT_EQ(parted.influence_weights, whole.influence_weights);
  EXPECT_EQ(parted.triangles, whole.triangles);
  EXPECT_EQ(parted.parts.size(), 2 * whole.parts.size());
  // Primitives with places of their own keep them.
  nodes::Primitive& second = scene.meshes[0].primitives[1];
  second.positions = shared(std::vector<Vec3f>(*second.positions));
  const auto again = *nodes::Evaluator::create(scene);
  EXPECT_EQ(import(scene, again).actor.model.positions.size(),
            whole.positions.size() + second.vertex_count());
}

TEST(ImportedShape, MeshesHungOnJointsFollowThem) {
  nodes::Scene scene = armature_scene();
  const int holder = add_node(scene, "Hand", 2, Vec3(5, 1, 2), from_rotation_vector(Vec3(1, 0, 0)));
  const int sword = add_mesh(scene, "Sword", holder, -1, 5);
  scene.nodes[static_cast<std::size_t>(sword)].scale = Vec3(3, -2, 5);  // mirrored too
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  EXPECT_LT(farthest(scene, evaluator, imported), 2e-6);
  ASSERT_EQ(imported.actor.model.parts.size(), 2u);
  // Neither the holder nor the mesh is a joint.
  EXPECT_EQ(imported.clip.joint_count(), 4);
}

// Painted characters would come back white, and textures of a second set would slide off. A part
// without colours is white, which looks the same.
TEST(ImportedShape, KeepsVertexColoursAndFurtherTextureCoordinates) {
  nodes::Scene scene = armature_scene();
  const int other = add_mesh(scene, "Plain", 2, -1, 5);
  nodes::Primitive& shape = scene.meshes.front().primitives.front();
  const std::size_t count = shape.vertex_count();
  std::vector<Vec4f> colours;
  std::vector<Vec2f> third;
  for (std::size_t v = 0; v < count; ++v) {
    const auto part = static_cast<float>(v) / static_cast<float>(count);
    colours.emplace_back(part, 1 - part, 0.25f, 0.5f);
    third.emplace_back(2 * part, -part);
  }
  shape.colours = std::make_shared<const std::vector<Vec4f>>(colours);
  shape.more_texture_coordinates = {nullptr, std::make_shared<const std::vector<Vec2f>>(third)};
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  const Model& model = imported.actor.model;
  const std::size_t all =
      count +
      scene.meshes[static_cast<std::size_t>(scene.nodes[static_cast<std::size_t>(other)].mesh)]
          .primitives.front()
          .vertex_count();
  ASSERT_EQ(model.colours.size(), all);
  const auto own = static_cast<std::ptrdiff_t>(count);  // the last, behind the plain mesh's
  ASSERT_EQ(model.more_texture_coordinates.size(), 2u);
  EXPECT_EQ(model.texture_coordinates.size(), all);
  EXPECT_TRUE(std::equal(colours.begin(), colours.end(), model.colours.end() - own));
  EXPECT_TRUE(
      std::equal(third.begin(), third.end(), model.more_texture_coordinates[1].end() - own));
  EXPECT_EQ(model.more_texture_coordinates[0], std::vector<Vec2f>(all, Vec2f::Zero()));
  EXPECT_EQ(model.colours.front(), Vec4f::Ones());
}

TEST(ImportedShape, AMirroredMeshKeepsItsOutside) {
  nodes::Scene scene = armature_scene();
  add_mesh(scene, "Plain", 2, -1, 5);
  const int mirrored = add_mesh(scene, "Mirrored", 2, -1, 5);
  scene.nodes[static_cast<std::size_t>(mirrored)].scale = Vec3(-1, 1, 1);
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Model model = import(scene, evaluator).actor.model;
  // Volumes against a point outside have the sign of the winding.
  const auto signed_sum = [&](const Model::Part& part) {
    double sum = 0;
    for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count;
         ++t) {
      const auto& c = model.triangles[t];
      const Vec3f normal = (model.positions[c[1]] - model.positions[c[0]])
                               .cross(model.positions[c[2]] - model.positions[c[0]]);
      sum += static_cast<double>(normal.dot(model.normals[c[0]]));
    }
    return sum;
  };
  ASSERT_EQ(model.parts.size(), 3u);
  ASSERT_EQ(model.parts[0].name, "Plain");
  ASSERT_EQ(model.parts[1].name, "Mirrored");
  const double a = signed_sum(model.parts[0]), b = signed_sum(model.parts[1]);
  ASSERT_GT(std::abs(a), 1e-9);
  EXPECT_NEAR(a, b, 1e-3 * std::abs(a));
}

TEST(ImportedShape, MovingScalesAreSaidWithJointAndSize) {
  nodes::Scene scene = armature_scene();
  add_channel(scene.animations[0], 2, nodes::Path::scale, 3, {0.1f, 0.5f}, {1, 1, 1, 1.5f, 1, 1});
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  Diagnostics dropped;
  ASSERT_TRUE(make_clip(evaluator, imported.rig, imported.conversion, 0, imported.sampling, 1,
                        nullptr, dropped)
                  .ok());
  for (const auto& [found, severity] : {std::pair{&imported.diagnostics, Severity::note},
                                        std::pair{&std::as_const(dropped), Severity::warning}}) {
    EXPECT_TRUE(has_code(*found, "scene-scale"));
    for (const Diagnostic& one : *found) {
      if (one.code != "scene-scale") continue;
      EXPECT_EQ(one.joint, "Spine");
      EXPECT_EQ(one.severity, severity);
      EXPECT_NE(one.message.find("50%"), std::string::npos) << one.message;
    }
  }
}

// Non-uniform scales under joints that turn shear the mesh below: what is kept must show it as it
// was, within the rounding of floats.
TEST(ImportedShape, ScalesOverTimeMoveTheMeshAsTheyDid) {
  nodes::Scene scene = armature_scene();
  add_channel(scene.animations[0], 1, nodes::Path::scale, 3, {0, 0.5f}, {1, 1, 1, 0.7f, 1.4f, 1});
  add_channel(scene.animations[0], 2, nodes::Path::scale, 3, {0.1f, 0.5f}, {1, 2, 1, -1.5f, 1, 1});
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  EXPECT_LT(farthest(scene, evaluator, imported), 3e-6);
  Imported rigid = imported;
  rigid.stretches.clear();
  EXPECT_GT(farthest(scene, evaluator, rigid), 0.05);
}

TEST(ImportedShape, AJointThatVanishesTakesItsVerticesWithIt) {
  nodes::Scene scene = armature_scene();
  add_channel(scene.animations[0], 2, nodes::Path::scale, 3, {0, 0.5f}, {1, 1, 1, 0, 0, 0});
  const auto evaluator = *nodes::Evaluator::create(scene);
  EXPECT_LT(farthest(scene, evaluator, import(scene, evaluator)), 3e-6);
}

// A root whose scale is not the same along all axes is not rigid in any frame but the bind pose's.
TEST(ImportedShape, ANonUniformRootKeepsItsShape) {
  nodes::Scene scene = armature_scene();
  scene.nodes[0].scale = 0.01 * Vec3(1, 0.6, 1.7);
  scene.skins.clear();
  scene.meshes.clear();
  scene.nodes.pop_back();
  scene.roots.pop_back();
  add_mesh(scene, "Body", -1, add_skin(scene, "Body", {1, 2, 3}));
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  ASSERT_FALSE(imported.stretches.empty());
  EXPECT_LT(farthest(scene, evaluator, imported), 3e-6);
}

// Less than 0.1 mm at a metre is what exporters leave by rounding: such motions stay rigid.
TEST(ImportedShape, RoundingOfScalesIsNoStretch) {
  nodes::Scene scene = armature_scene();
  add_channel(scene.animations[0], 2, nodes::Path::scale, 3, {0, 0.5f},
              {1, 1, 1, 1.00008f, 0.99995f, 1});
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  EXPECT_TRUE(imported.stretches.empty());
  EXPECT_FALSE(has_code(imported.diagnostics, "scene-scale"));
}

TEST(ImportedShape, SeveralSkinsShareASkeleton) {
  nodes::Scene scene = armature_scene();
  Mat4 shifted = Mat4::Identity();
  shifted.topRightCorner<3, 1>() = Vec3(3, 2, 1);
  const int hair = add_skin(scene, "Hair", {3, 2}, shifted);
  add_mesh(scene, "Hair", 3, hair, 9);
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  EXPECT_LT(farthest(scene, evaluator, imported), 3e-6);
  EXPECT_FALSE(has_code(imported.diagnostics, "scene-bind"));
  EXPECT_EQ(imported.clip.joint_count(), 4);
}

TEST(ImportedShape, SkinsThatDisagreeAreSaid) {
  nodes::Scene scene = armature_scene();
  const int hair = add_skin(scene, "Hair", {3, 2});
  scene.skins[static_cast<std::size_t>(hair)].inverse_binds[0](0, 3) += 7.0;
  add_mesh(scene, "Hair", 3, hair, 9);
  const auto evaluator = *nodes::Evaluator::create(scene);
  EXPECT_TRUE(has_code(import(scene, evaluator).diagnostics, "scene-bind"));
}

TEST(ImportedShape, MatricesOfJointsWithoutVerticesMayBeAnything) {
  nodes::Scene scene = armature_scene();
  scene.skins[0].joints.push_back(4);  // Head_end, with a matrix that an exporter left as it was
  scene.skins[0].inverse_binds.push_back(Mat4::Identity());
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  EXPECT_LT(farthest(scene, evaluator, imported), 2e-6);
  EXPECT_FALSE(has_code(imported.diagnostics, "scene-scale"));
  const Skeleton& skeleton = imported.clip.skeleton;
  EXPECT_NEAR((skeleton.reference[3].position - skeleton.reference[2].position).norm(), 0.2, 1e-9);
}

// Some exporters write the identity for each joint that only controls others: the whole trunk would
// be at the origin, and the character retargeted in pieces.
TEST(ImportedShape, ControlsWithTheIdentityAreWhereTheirNodesAre) {
  nodes::Scene scene;
  const int armature =
      add_node(scene, "Armature", -1, Vec3::Zero(), from_rotation_vector(Vec3(-1.5, 0, 0)), 0.01);
  const int root = add_node(scene, "root", armature);
  const int torso = add_node(scene, "torso", root, Vec3(0, 0, 60));
  const int control = add_node(scene, "spine_fk", torso, Vec3(0, 0, 20));
  const int thigh = add_node(scene, "thigh", torso, Vec3(10, 0, -2));
  const int shin = add_node(scene, "shin", thigh, Vec3(0, 0, -25));
  const int head = add_node(scene, "head", control, Vec3(0, 3, 30));
  Mat4 mesh_to_world = Mat4::Identity();
  mesh_to_world.topLeftCorner<3, 3>() *= 0.01;
  const int skin = add_skin(scene, "Skin", {thigh, shin, head}, mesh_to_world);
  add_mesh(scene, "Body", -1, skin);
  for (const int joint : {root, torso, control}) {
    scene.skins[0].joints.push_back(joint);
    scene.skins[0].inverse_binds.push_back(Mat4::Identity());
  }
  add_channel(scene.animations.emplace_back(), shin, nodes::Path::rotation, 4, {0.0f, 0.5f},
              {0, 0, 0, 1, 0, 0, 0.6f, 0.8f});
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  EXPECT_LT(farthest(scene, evaluator, imported), 2e-6);
  EXPECT_FALSE(has_code(imported.diagnostics, "scene-scale"));
  const Skeleton& skeleton = imported.clip.skeleton;
  const auto apart = [&](const char* a, const char* b) {
    const auto place = [&](const char* name) {
      return skeleton.reference[static_cast<std::size_t>(skeleton.find(name))].position;
    };
    return (place(a) - place(b)).norm();
  };
  EXPECT_NEAR(apart("root", "torso"), 0.6, 1e-9);
  EXPECT_NEAR(apart("torso", "spine_fk"), 0.2, 1e-9);
  EXPECT_NEAR(apart("spine_fk", "head"), std::hypot(0.03, 0.3), 1e-9);
}

TEST(ImportedShape, TargetsStandInTheReferencePose) {
  nodes::Scene scene = armature_scene();
  const auto give_targets = [&](std::size_t mesh, const Vec3f& move) {
    nodes::Primitive& shape = scene.meshes[mesh].primitives[0];
    nodes::MorphTarget target;
    target.name = "Smile";
    target.positions = shared(std::vector<Vec3f>(shape.vertex_count(), move));
    shape.targets.push_back(target);
    target.name.clear();
    shape.targets.push_back(target);
    scene.meshes[mesh].weights = {0.0, 0.25};
  };
  give_targets(0, Vec3f(0, 0, 2));
  add_mesh(scene, "Teeth", 3, -1, 7);
  give_targets(1, Vec3f(1, 0, 0));
  const auto evaluator = *nodes::Evaluator::create(scene);
  const Imported imported = import(scene, evaluator);
  const MorphSet& morphs = imported.actor.morphs;
  ASSERT_EQ(morphs.names, (std::vector<std::string>{"Smile", "Teeth_1", "Body_1"}));
  ASSERT_EQ(morphs.vertex_count, imported.actor.model.vertex_count());
  const auto& base = imported.actor.model.positions;
  for (int t = 0; t < 3; ++t) {
    for (std::size_t v = 0; v < base.size(); ++v) {
      const bool body = v >= 12;  // after the teeth in the outline
      const bool moved = t == 0 || (t == 2) == body;
      const double distance = (morphs.target_positions(t)[v] - base[v]).norm();
      // The body is bound at half its size, the teeth are in the armature's centimetres.
      EXPECT_NEAR(distance, !moved ? 0.0 : body ? 1.0 : 0.01, 1e-6) << t << " " << v;
    }
  }
  const auto weights = make_weights(imported.actor, evaluator, 0, imported.sampling);
  ASSERT_TRUE(weights.ok());
  EXPECT_EQ(weights->frame_count(), 13);
  EXPECT_EQ(weights->values[1], 0.25f);
  Sampling endless = imported.sampling;
  endless.frames = 2'000'000'000;
  const auto too_long = make_weights(imported.actor, evaluator, 0, endless);
  ASSERT_FALSE(too_long.ok());
  EXPECT_EQ(too_long.error().code, "scene-too-long");
}

// Model's are of length 1, so one that has no direction cannot stand among them.
TEST(ImportedShape, ATangentThatIsZeroTakesTheOthersWithIt) {
  std::vector<Vec4f> tangents(12, Vec4f(1, 0, 0, 1));
  for (const bool zero : {false, true}) {
    if (zero) tangents[3] = Vec4f(0, 0, 0, 1);
    nodes::Scene scene = armature_scene();
    scene.meshes[0].primitives[0].tangents = shared(std::vector<Vec4f>(tangents));
    const auto evaluator = *nodes::Evaluator::create(scene);
    const Imported imported = import(scene, evaluator);
    EXPECT_EQ(imported.actor.model.tangents.size(), zero ? 0u : 12u);
    EXPECT_EQ(std::ranges::count(imported.diagnostics, "scene-tangents", &Diagnostic::code),
              zero ? 1 : 0);
  }
}

}  // namespace
}  // namespace krok::test
