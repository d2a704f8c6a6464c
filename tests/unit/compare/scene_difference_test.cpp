// If these fail, comparing glTF scenes by what they show overlooks a difference, or names the wrong
// vertex and moment.

#include "compare/scene_difference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "compare/mesh_difference.h"
#include "unit/compare/compare_scenes.h"

namespace krok::compare {
namespace {

const std::vector<Triangle>& one_triangle() {
  static const std::vector<Triangle> list = {{0, 1, 2}};
  return list;
}

// A triangle that moves along X by a metre a second, and one joint with it.
Scene moving_triangle(int keys = 11) {
  Scene scene;
  SceneMesh mesh;
  mesh.name = "Body";
  mesh.vertex_count = 3;
  mesh.has_normals = true;
  mesh.triangles = one_triangle();
  scene.meshes.push_back(mesh);
  scene.joint_names = {"Hips"};
  scene.joint_parents = {-1};
  Scene::Animation animation{"Walk", {}};
  for (int k = 0; k < keys; ++k) animation.key_times.push_back(0.1 * k);
  scene.animations.push_back(animation);
  scene.evaluate = [](int which, double time, SceneState& state) {
    const double x = which < 0 ? 0.0 : time;
    state.positions = {{Vec3(x, 0, 0), Vec3(x + 1, 0, 0), Vec3(x, 1, 0)}};
    state.normals = {{Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 0, 1)}};
    state.joints = {{Vec3(x, 0, 0), Quat::Identity()}};
  };
  return scene;
}

// The same with a change of its state.
Scene changed(std::function<void(double time, SceneState&)> change, int keys = 11) {
  Scene scene = moving_triangle(keys);
  scene.evaluate = [plain = scene.evaluate, change](int which, double time, SceneState& state) {
    plain(which, time, state);
    change(time, state);
  };
  return scene;
}

TEST(SceneDifference, ASceneIsTheSameAsItself) {
  const SceneDifference found = compare_scenes(moving_triangle(), moving_triangle());
  EXPECT_TRUE(found.same());
  EXPECT_TRUE(found.notes.empty());
  EXPECT_EQ(found.compared_times, 11);
  EXPECT_EQ(found.positions.count, 33);
  EXPECT_EQ(found.joint_positions.count, 11);
}

TEST(SceneDifference, FindsOneVertexMovedByATenthOfAMillimetreInOneFrame) {
  for (const int jobs : {1, 2, 5}) {
    const SceneDifference found =
        compare_scenes(moving_triangle(), changed([](double time, SceneState& state) {
                         if (std::abs(time - 0.7) < 1e-9) {
                           state.positions[0][2].y() += 1e-4;
                         }
                       }),
                       Matching::automatic, jobs);
    EXPECT_FALSE(found.same());
    EXPECT_NEAR(found.positions.largest, 1e-4, 1e-12);
    EXPECT_EQ(found.positions.over, 1);
    EXPECT_EQ(found.positions.where.mesh, 0);
    EXPECT_EQ(found.positions.where.vertex, 2);
    EXPECT_EQ(found.positions.where.frame, 7);
    EXPECT_NEAR(found.positions.where.time, 0.7, 1e-12);
    EXPECT_TRUE(found.normals.within());
  }
}

// What a viewer shows before an animation is chosen; the animations hide it.
TEST(SceneDifference, FindsAJointThatIsTurnedAtRestAlone) {
  Scene other = moving_triangle();
  other.evaluate = [plain = other.evaluate](int which, double time, SceneState& state) {
    plain(which, time, state);
    if (which < 0) state.joints[0].orientation = Eigen::AngleAxisd(kPi / 4, Vec3::UnitX());
  };
  for (const bool swapped : {false, true}) {
    const SceneDifference found = swapped ? compare_scenes(other, moving_triangle())
                                          : compare_scenes(moving_triangle(), other);
    EXPECT_FALSE(found.same());
    ASSERT_EQ(found.structure.size(), 1u);
    EXPECT_EQ(found.structure[0], "without an animation, at rest: joint Hips is turned by 45 deg");
    EXPECT_TRUE(found.joint_orientations.within());
  }
  // A motion's reference pose is not the pose in which a mesh is bound.
  other.only_joints = true;
  other.meshes.clear();
  const SceneDifference motion = compare_scenes(moving_triangle(), other);
  EXPECT_TRUE(motion.same()) << motion.structure[0];
  EXPECT_THAT(motion.notes, testing::Contains(testing::HasSubstr("at rest: joint Hips")));
}

TEST(SceneDifference, ResultsDoNotDependOnTheNumberOfJobs) {
  const Scene other = changed([](double time, SceneState& state) {
    for (Vec3& p : state.positions[0]) p.z() += 1e-3 * std::sin(40 * time);
  });
  const SceneDifference one = compare_scenes(moving_triangle(500), other, Matching::automatic, 1);
  const SceneDifference many = compare_scenes(moving_triangle(500), other, Matching::automatic, 7);
  EXPECT_EQ(one.positions.square_sum, many.positions.square_sum);
  EXPECT_EQ(one.positions.largest, many.positions.largest);
  EXPECT_EQ(one.positions.where.frame, many.positions.where.frame);
}

TEST(SceneDifference, ComparesAtTheKeysOfBoth) {
  // The second leaves the line between the first's keys only.
  const Scene other = changed(
      [](double time, SceneState& state) {
        if (std::abs(time - 0.05) < 1e-9) state.positions[0][1].x() += 0.5;
      },
      11);
  Scene finer = other;
  finer.animations[0].key_times = {0, 0.05, 1.0};
  const SceneDifference found = compare_scenes(moving_triangle(), finer);
  EXPECT_EQ(found.compared_times, 12);
  EXPECT_EQ(found.positions.largest, 0.5);
  EXPECT_EQ(found.notes.size(), 1u);
  // Times that only rounding parts are one.
  Scene rounded = moving_triangle();
  for (double& time : rounded.animations[0].key_times) time += 3e-8;
  EXPECT_EQ(compare_scenes(moving_triangle(), rounded).compared_times, 11);
}

TEST(SceneDifference, AnotherDurationDiffersButWhatIsCommonIsCompared) {
  const SceneDifference found = compare_scenes(moving_triangle(11), moving_triangle(6));
  EXPECT_FALSE(found.same());
  EXPECT_EQ(found.compared_times, 6);
  EXPECT_TRUE(found.positions.within());
  ASSERT_EQ(found.structure.size(), 1u);
}

TEST(SceneDifference, MeshesAreMatchedByNameOrElseByPlace) {
  const auto two = [](bool swapped, const char* second_name) {
    Scene scene = moving_triangle();
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes[1].name = second_name;
    scene.evaluate = [swapped](int, double, SceneState& state) {
      state.positions = {std::vector<Vec3>(3, Vec3(0, 0, 0)), std::vector<Vec3>(3, Vec3(5, 5, 5))};
      state.normals.assign(2, std::vector<Vec3>(3, Vec3(0, 0, 1)));
      state.joints = {Transform()};
      if (swapped) std::swap(state.positions[0], state.positions[1]);
    };
    if (swapped) std::swap(scene.meshes[0], scene.meshes[1]);
    return scene;
  };
  EXPECT_TRUE(compare_scenes(two(false, "Hat"), two(true, "Hat")).same());
  EXPECT_FALSE(compare_scenes(two(false, "Body"), two(true, "Body")).same());
  EXPECT_TRUE(compare_scenes(two(false, "Body"), two(false, "Body")).same());
}

TEST(SceneDifference, SaysWhatDiffersInStructure) {
  Scene other = moving_triangle();
  other.meshes[0].vertex_count = 4;
  EXPECT_EQ(compare_scenes(moving_triangle(), other).structure.at(0),
            "mesh Body: 3 vertices in the first, 4 in the second");
  other = moving_triangle();
  const std::vector<Triangle> turned = {{0, 2, 1}};
  other.meshes[0].triangles = turned;
  EXPECT_EQ(compare_scenes(moving_triangle(), other).structure.at(0),
            "mesh Body: inside out in the second: its triangles are wound the other way");
  other = moving_triangle();
  other.joint_names = {"Pelvis"};
  EXPECT_NE(
      compare_scenes(moving_triangle(), other).structure.at(0).find("only in the second: Pelvis"),
      std::string::npos);
  other = moving_triangle();
  other.meshes.clear();
  EXPECT_EQ(compare_scenes(moving_triangle(), other).structure.at(0),
            "1 mesh in the first, 0 in the second");
  other = moving_triangle();
  other.animations.clear();
  EXPECT_FALSE(compare_scenes(moving_triangle(), other).same());
}

TEST(SceneDifference, ARigAgainstItsBakedMotionIsComparedByVertices) {
  const std::vector<std::uint16_t> joints(3, 0);
  const std::vector<float> weights(3, 1.0f);
  Scene rig = moving_triangle();
  rig.meshes[0].influences = {1, joints, weights};
  const std::vector<Vec3f> displacements(3, Vec3f(1, 0, 0));
  Scene baked = moving_triangle();
  baked.joint_names.clear();
  baked.joint_parents.clear();
  baked.meshes[0].targets = {{"frame 1", displacements, {}}};
  const SceneDifference found = compare_scenes(rig, baked);
  EXPECT_TRUE(found.same());
  EXPECT_TRUE(found.structure.empty());
  EXPECT_EQ(found.notes.size(), 3u);  // joints, targets, skin
  EXPECT_EQ(found.joint_positions.count, 0);

  // Two with other numbers of targets and no skin are no such pair.
  Scene more = baked;
  more.meshes[0].targets.push_back(more.meshes[0].targets[0]);
  EXPECT_FALSE(compare_scenes(baked, more).same());
}

TEST(SceneDifference, ComparesMorphTargetsAndWeightsThemselves) {
  const std::vector<Vec3f> one(3, Vec3f(1, 0, 0));
  std::vector<Vec3f> two = one;
  two[1].y() = 0.5f;
  Scene a = moving_triangle();
  Scene b = moving_triangle();
  a.meshes[0].targets = {{"smile", one, {}}};
  b.meshes[0].targets = {{"smile", two, {}}};
  const SceneDifference shapes = compare_scenes(a, b);
  EXPECT_EQ(shapes.target_positions.largest, 0.5);
  EXPECT_EQ(shapes.target_positions.where.vertex, 1);
  EXPECT_EQ(shapes.target_positions.where.target, 0);
  EXPECT_FALSE(shapes.same());

  const std::vector<std::uint16_t> joints(6, 0);
  const std::vector<float> whole = {1, 0, 1, 0, 1, 0};
  const std::vector<float> less = {1, 0, 1, 0, 0.75f, 0};
  a = b = moving_triangle();
  a.meshes[0].influences = {2, joints, whole};
  b.meshes[0].influences = {2, joints, less};
  const SceneDifference skins = compare_scenes(a, b);
  EXPECT_EQ(skins.weights.largest, 0.25);
  EXPECT_EQ(skins.weights.where.vertex, 2);
}

TEST(SceneDifference, TellsMomentsPartsJointsAndVertices) {
  const Scene other = changed([](double time, SceneState& state) {
    if (std::abs(time - 0.7) < 1e-9) state.positions[0][2].y() += 1e-3;
    if (std::abs(time - 0.3) < 1e-9) state.joints[0].position.z() += 2e-3;
  });
  for (const int jobs : {1, 3}) {
    Progress progress;
    SceneOptions options;
    options.keep_vertices = true;
    const auto found = difference(moving_triangle(), other, options, jobs, progress);
    ASSERT_TRUE(found.ok());
    ASSERT_EQ(found->moments.size(), 11u);
    for (int f = 0; f < 11; ++f) {
      const MomentDifference& moment = found->moments[static_cast<std::size_t>(f)];
      EXPECT_EQ(moment.frame, f);
      EXPECT_NEAR(moment.time, 0.1 * f, 1e-12);
      EXPECT_NEAR(moment.positions.largest, f == 7 ? 1e-3 : 0, 1e-9);
      EXPECT_NEAR(moment.positions.rms, f == 7 ? 1e-3 / std::sqrt(3.0) : 0, 1e-9);
      EXPECT_NEAR(moment.joint_positions.largest, f == 3 ? 2e-3 : 0, 1e-9);
    }
    EXPECT_EQ(found->moments[7].positions.item, 2);
    EXPECT_EQ(found->moments[3].joint_positions.item, 0);
    ASSERT_EQ(found->parts.size(), 1u);
    EXPECT_EQ(found->parts[0].positions.where.frame, 7);
    EXPECT_EQ(found->parts[0].positions.count, 33);
    ASSERT_EQ(found->joints.size(), 1u);
    EXPECT_EQ(found->joints[0].positions.over, 1);
    // 1 of 33 differs: 95 % do not, 98 % do.
    EXPECT_EQ(found->positions.percentile(0.95), 0);
    EXPECT_NEAR(found->positions.percentile(0.98), 1e-3, 1e-12);
    EXPECT_EQ(found->vertex_largest.at(0).at(1), 0.0F);
    EXPECT_NEAR(found->vertex_largest.at(0).at(2), 1e-3, 1e-9);
  }
  EXPECT_TRUE(compare_scenes(moving_triangle(), other).vertex_largest.empty());
}

TEST(SceneDifference, KeyTimesWithinTheToleranceAreOneMomentEachAtItsOwnTime) {
  // The same poses at keys that stand 3 ms later.
  Scene late = moving_triangle();
  for (double& time : late.animations[0].key_times) time += 3e-3;
  late.evaluate = [plain = late.evaluate](int which, double time, SceneState& state) {
    plain(which, time - 3e-3, state);
  };
  EXPECT_FALSE(compare_scenes(moving_triangle(), late).same());
  Progress progress;
  SceneOptions options;
  options.tolerance.time = 4e-3;
  const auto found = difference(moving_triangle(), late, options, 1, progress);
  ASSERT_TRUE(found.ok());
  EXPECT_TRUE(found->same());
  EXPECT_EQ(found->compared_times, 11);
  EXPECT_NEAR(found->times.largest, 3e-3, 1e-12);
  // A tolerance wider than the keys are apart neither drops nor shifts any.
  options.tolerance.time = 0.25;
  EXPECT_EQ(difference(moving_triangle(), moving_triangle(), options, 1, progress)->compared_times,
            11);
  EXPECT_TRUE(difference(moving_triangle(), moving_triangle(), options, 1, progress)->same());
}

TEST(SceneDifference, MatchingByNameComparesWhatBothHave) {
  Scene other = moving_triangle();
  other.meshes.push_back(other.meshes[0]);
  other.meshes[0].name = "Hat";
  other.joint_names = {"Pelvis"};
  other.evaluate = [plain = other.evaluate](int which, double time, SceneState& state) {
    plain(which, time, state);
    state.positions.push_back(state.positions[0]);
    state.normals.push_back(state.normals[0]);
    for (Vec3& position : state.positions[0]) position.x() += 5;  // the hat is elsewhere
  };
  Progress progress;
  SceneOptions options;
  options.matching = Matching::name;
  const auto found = difference(moving_triangle(), other, options, 1, progress);
  ASSERT_TRUE(found.ok());
  ASSERT_EQ(found->structure.size(), 2u);
  EXPECT_EQ(found->structure[0],
            "skeletons differ: both have 1 joint; only in the first: Hips; only in the second: "
            "Pelvis");
  EXPECT_EQ(found->structure[1], "only in the second: mesh Hat");
  EXPECT_EQ(found->positions.count, 33);
  EXPECT_TRUE(found->positions.within());
  EXPECT_EQ(found->joint_positions.count, 0);
  options.matching = Matching::order;
  EXPECT_EQ(difference(moving_triangle(), other, options, 1, progress)->positions.largest, 5);
}

TEST(SceneDifference, ValuesThatAreNotNumbersAreTrouble) {
  Progress progress;
  const Scene bad = changed([](double, SceneState& state) {
    state.positions[0][0].x() = std::numeric_limits<double>::quiet_NaN();
  });
  const auto found = difference(moving_triangle(), bad, {}, 1, progress);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, "compare-value");
}

// With a material for its first mesh, or with none.
Scene scene_with(const Material* material) {
  Scene scene = moving_triangle();
  scene.knows_materials = true;
  scene.meshes[0].material = material;
  return scene;
}

// Materials are no fault of a mesh's motion, but who compares is to know.
TEST(SceneDifference, OtherMaterialsAreTold) {
  Material grey, red;
  red.base_color = {1, 0, 0, 1};
  const std::string told = "mesh Body, material: base colour 0.8, 0.8, 0.8, 1 and 1, 0, 0, 1";
  SceneDifference found = compare_scenes(scene_with(&grey), scene_with(&red));
  EXPECT_TRUE(found.same());
  EXPECT_EQ(found.notes, std::vector<std::string>{told});

  SceneOptions strict;
  strict.materials = true;
  Progress progress;
  const Scene first = scene_with(&grey), second = scene_with(&red);
  found = *difference(first, second, strict, 1, progress);
  EXPECT_FALSE(found.same());
  EXPECT_EQ(found.structure, std::vector<std::string>{told});
  const Scene bare = scene_with(nullptr);
  EXPECT_FALSE(difference(first, bare, strict, 1, progress)->same());
  EXPECT_TRUE(difference(bare, bare, strict, 1, progress)->same());
  // A file of another kind, which cannot tell.
  EXPECT_TRUE(difference(first, moving_triangle(), strict, 1, progress)->same());
}

TEST(SceneDifference, AMaterialOfManyMeshesIsToldOnce) {
  Material grey, red;
  red.base_color = {1, 0, 0, 1};
  const auto two = [](const Material* material) {
    Scene scene = scene_with(material);
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes[1].name = "Hat";
    scene.evaluate = [plain = scene.evaluate](int which, double time, SceneState& state) {
      plain(which, time, state);
      state.positions.push_back(state.positions[0]);
      state.normals.push_back(state.normals[0]);
    };
    return scene;
  };
  EXPECT_EQ(compare_scenes(two(&grey), two(&red)).notes.size(), 1u);
}

// Engines look clips, meshes and materials up by name.
TEST(SceneDifference, AnotherNameIsADifferenceThatNamesBoth) {
  Material skin, cloth;
  skin.name = "skin";
  cloth.name = "cloth";
  SceneOptions by_order, by_name, strict;
  by_order.matching = Matching::order;
  strict.materials = true;
  Progress progress;
  const Scene first = scene_with(&skin);

  Scene other = scene_with(&skin);
  other.animations[0].name = "Run";
  const SceneDifference clip = compare_scenes(first, other);
  EXPECT_FALSE(clip.same());
  EXPECT_EQ(clip.structure, std::vector<std::string>{"animation Walk is named Run in the second"});
  EXPECT_EQ(clip.compared_times, 11) << "the motions are compared all the same";
  EXPECT_TRUE(difference(first, other, by_order, 1, progress)->same());
  other.animations[0].name = "";
  EXPECT_TRUE(compare_scenes(first, other).same()) << "a file without names";

  other = scene_with(&skin);
  other.meshes[0].name = "Torso";
  const SceneDifference mesh = compare_scenes(first, other);
  EXPECT_TRUE(mesh.same()) << "parts of other names are matched by their order";
  EXPECT_EQ(mesh.notes, std::vector<std::string>{"mesh Body is named Torso in the second"});
  by_name.matching = Matching::name;
  EXPECT_FALSE(difference(first, other, by_name, 1, progress)->same());

  other = scene_with(&cloth);
  const std::string named = "mesh Body, material: named skin and cloth";
  EXPECT_EQ(compare_scenes(first, other).notes, std::vector<std::string>{named});
  EXPECT_EQ(difference(first, other, strict, 1, progress)->structure,
            std::vector<std::string>{named});
}

TEST(SceneDifference, OneRenamedClipOfSeveralInAnotherOrderIsFound) {
  const auto with = [](const std::vector<std::string>& names) {
    Scene scene = moving_triangle();
    scene.animations.resize(names.size(), scene.animations[0]);
    for (std::size_t i = 0; i < names.size(); ++i) scene.animations[i].name = names[i];
    return scene;
  };
  EXPECT_EQ(
      compare_scenes(with({"Walk", "Run", "Idle"}), with({"Idle", "Walk", "Sprint"})).structure,
      std::vector<std::string>{"animation Run is named Sprint in the second"});
  // Would fail if packs of other clips were compared by their order, with a false reason.
  EXPECT_EQ(compare_scenes(with({"Walk", "Jog", "Sprint", "Hit"}), with({"Jog", "Sprint", "Dash"}))
                .structure,
            std::vector<std::string>{
                "4 animations in the first, 3 in the second; only in the first: animation Walk, "
                "animation Hit; only in the second: animation Dash"});
  SceneOptions by_name;
  by_name.matching = Matching::name;
  Progress progress;
  EXPECT_EQ(
      difference(with({"Walk", "Jog"}), with({"Jog", "Dash"}), by_name, 1, progress)->structure,
      std::vector<std::string>{"2 animations in the first, 2 in the second; only in the "
                               "first: animation Walk; only in the second: animation Dash"});
}

}  // namespace
}  // namespace krok::compare
