// If these fail, a mesh whose tangents have changed, which normal maps show, is said to be the
// same, or one that has not to differ.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/mesh_difference.h"
#include "compare/scene_difference.h"
#include "unit/compare/compare_scenes.h"

namespace krok::compare {
namespace {

using Change = std::function<void(double time, SceneState&)>;

const std::vector<Triangle>& square_triangles() {
  static const std::vector<Triangle> list = {{0, 1, 2}, {0, 2, 3}};
  return list;
}

// A square that turns about Z, its tangents with it, on another side at every second vertex.
Scene turning_square(const Change& change = {}) {
  Scene scene;
  SceneMesh mesh;
  mesh.name = "Body";
  mesh.vertex_count = 4;
  mesh.has_normals = mesh.has_tangents = true;
  mesh.triangles = square_triangles();
  scene.meshes.push_back(mesh);
  scene.knows_materials = true;
  Scene::Animation animation{"Turn", {}};
  for (int k = 0; k < 60; ++k) animation.key_times.push_back(k / 30.0);
  scene.animations.push_back(animation);
  scene.evaluate = [change](int, double time, SceneState& state) {
    const double c = std::cos(time), s = std::sin(time);
    state.positions = {{Vec3(0, 0, 0), Vec3(c, s, 0), Vec3(c - s, s + c, 0), Vec3(-s, c, 0)}};
    state.normals = {std::vector<Vec3>(4, Vec3(0, 0, 1))};
    state.tangents = {{Vec4(c, s, 0, 1), Vec4(c, s, 0, -1), Vec4(c, s, 0, 1), Vec4(c, s, 0, -1)}};
    if (change) change(time, state);
  };
  return scene;
}

bool is_frame(double time, int frame) {
  return std::abs(time - frame / 30.0) < 1e-9;
}

// One tangent turned by a degree in one frame.
void turn_one(double time, SceneState& state) {
  if (!is_frame(time, 37)) return;
  const double angle = time + kRadiansPerDegree;
  state.tangents[0][2] = Vec4(std::cos(angle), std::sin(angle), 0, 1);
}

TEST(Tangents, TheSameAreTheSame) {
  const SceneDifference found = compare_scenes(turning_square(), turning_square());
  EXPECT_TRUE(found.same());
  EXPECT_EQ(found.tangents.count, 4 * 60);
  EXPECT_EQ(found.tangent_sides.count, 4 * 60);
  EXPECT_EQ(found.tangents.largest, 0);
  EXPECT_TRUE(found.notes.empty());
}

TEST(Tangents, OneTurnedByADegreeInFrame37IsFoundAndNamed) {
  for (const Matching matching : {Matching::automatic, Matching::nearest}) {
    for (const int jobs : {1, 3}) {
      const SceneDifference found =
          compare_scenes(turning_square(), turning_square(turn_one), matching, jobs);
      EXPECT_FALSE(found.same());
      EXPECT_NEAR(found.tangents.largest, kRadiansPerDegree, 1e-9);
      EXPECT_EQ(found.tangents.where.mesh, 0);
      EXPECT_EQ(found.tangents.where.vertex, 2);
      EXPECT_EQ(found.tangents.where.frame, 37);
      EXPECT_TRUE(found.positions.within());
      EXPECT_TRUE(found.normals.within());
      EXPECT_TRUE(found.tangent_sides.within());
      EXPECT_EQ(found.parts.at(0).tangents.over, 1);
      EXPECT_NEAR(found.parts[0].tangents.rms(), kRadiansPerDegree / std::sqrt(240.0), 1e-9);
      EXPECT_EQ(found.parts[0].tangents.percentile(0.95), 0);
      EXPECT_NEAR(found.moments.at(37).tangents.largest, kRadiansPerDegree, 1e-7);
      EXPECT_EQ(found.moments[37].tangents.item, 2);
      EXPECT_EQ(found.moments[36].tangents.largest, 0);
    }
  }
}

TEST(Tangents, TheToleranceIsThatOfNormals) {
  Progress progress;
  SceneOptions options;
  options.tolerance.normals = 1.1 * kRadiansPerDegree;
  const Scene first = turning_square(), second = turning_square(turn_one);
  EXPECT_TRUE(difference(first, second, options, 1, progress)->same());
  options.tolerance.normals = 0.9 * kRadiansPerDegree;
  options.tolerance.angle = 1;
  EXPECT_FALSE(difference(first, second, options, 1, progress)->same());
}

TEST(Tangents, TheOtherHandednessIsADifferenceOfItsOwn) {
  const Scene other = turning_square([](double time, SceneState& state) {
    if (is_frame(time, 5)) state.tangents[0][3].w() = 1;
  });
  for (const Matching matching : {Matching::automatic, Matching::nearest}) {
    const SceneDifference found = compare_scenes(turning_square(), other, matching);
    EXPECT_FALSE(found.same());
    EXPECT_TRUE(found.tangents.within());
    EXPECT_EQ(found.tangent_sides.where.vertex, 3);
    EXPECT_EQ(found.tangent_sides.where.frame, 5);
    EXPECT_EQ(found.parts.at(0).tangent_sides.over, 1);
  }
  // However wide the tolerance is.
  Progress progress;
  SceneOptions wide;
  wide.tolerance.normals = 10;
  wide.tolerance.ratio = 10;
  EXPECT_FALSE(difference(turning_square(), other, wide, 1, progress)->same());
}

TEST(Tangents, ThoseThatVanishHaveNeitherDirectionNorSide) {
  const Scene zero = turning_square([](double, SceneState& state) {
    state.tangents[0][1] = Vec4(0, 0, 0, 1);  // the others' is on the other side
  });
  SceneDifference found = compare_scenes(turning_square(), zero);
  EXPECT_FALSE(found.same());
  EXPECT_EQ(found.tangents.largest, kPi);
  EXPECT_EQ(found.tangents.where.vertex, 1);
  EXPECT_TRUE(found.tangent_sides.within());
  const Scene other_side =
      turning_square([](double, SceneState& state) { state.tangents[0][1] = Vec4(0, 0, 0, -1); });
  EXPECT_TRUE(compare_scenes(zero, other_side).same());
  EXPECT_FALSE(on_other_sides(Vec4(1, 0, 0, 1), Vec4(1, 0, 0, -0.4)));  // between two sides
  EXPECT_TRUE(on_other_sides(Vec4(1, 0, 0, 1), Vec4(0, 1, 0, -0.9)));
}

TEST(Tangents, OneThatIsNotANumberIsADifference) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Scene bad = turning_square([nan](double time, SceneState& state) {
    if (is_frame(time, 8)) state.tangents[0][1].x() = nan;
  });
  for (const Matching matching : {Matching::automatic, Matching::nearest}) {
    const SceneDifference found = compare_scenes(turning_square(), bad, matching);
    EXPECT_FALSE(found.same());
    EXPECT_TRUE(std::isinf(found.tangents.largest));
    EXPECT_EQ(found.tangents.where.vertex, 1);
    EXPECT_EQ(found.tangents.where.frame, 8);
  }
}

Scene without_tangents() {
  Scene scene = turning_square([](double, SceneState& state) { state.tangents.clear(); });
  scene.meshes[0].has_tangents = false;
  return scene;
}

TEST(Tangents, ThatOnlyOneHasThemIsADifferenceWhereANormalTextureShowsThem) {
  for (const Matching matching : {Matching::automatic, Matching::nearest}) {
    const std::string before = matching == Matching::nearest ? "" : "mesh Body: ";
    SceneDifference found = compare_scenes(turning_square(), without_tangents(), matching);
    EXPECT_TRUE(found.same());
    EXPECT_EQ(found.notes, std::vector<std::string>{
                               before + "only the first has tangents, so they are not compared"});
    EXPECT_EQ(found.tangents.count, 0);

    Material bumpy;
    bumpy.normal_texture.image = std::make_shared<EncodedImage>();
    Scene first = without_tangents(), second = turning_square();
    first.meshes[0].material = second.meshes[0].material = &bumpy;
    found = compare_scenes(first, second, matching);
    EXPECT_FALSE(found.same());
    EXPECT_EQ(found.structure,
              std::vector<std::string>{before +
                                       "only the second has tangents, which normal textures need"});
    // A normal texture that is new brings its tangents along, and other materials are no fault.
    Material plain;
    first.meshes[0].material = &plain;
    found = compare_scenes(first, second, matching);
    EXPECT_TRUE(found.same());
    EXPECT_FALSE(found.notes.empty());
    first.meshes[0].material = &bumpy;
    // A file of a kind that knows no materials cannot tell.
    first.knows_materials = false;
    EXPECT_TRUE(compare_scenes(first, second, matching).same());
  }
  EXPECT_TRUE(compare_scenes(without_tangents(), without_tangents()).notes.empty());
}

TEST(Tangents, WhatMorphTargetsDoToThemIsCompared) {
  const std::vector<Vec3f> still(4, Vec3f::Zero());
  std::vector<Vec3f> moved = still;
  moved[3].y() = 0.25f;
  Scene a = turning_square(), b = turning_square();
  a.meshes[0].targets = {{"frame 1", still, {}, still}};
  b.meshes[0].targets = {{"frame 1", still, {}, moved}};
  const SceneDifference found = compare_scenes(a, b);
  EXPECT_FALSE(found.same());
  EXPECT_EQ(found.target_tangents.largest, 0.25);
  EXPECT_EQ(found.target_tangents.where.vertex, 3);
  // One that says nothing of them moves none.
  a.meshes[0].targets[0].tangents = {};
  EXPECT_EQ(compare_scenes(a, b).target_tangents.largest, 0.25);
  b.meshes[0].targets[0].tangents = {};
  EXPECT_EQ(compare_scenes(a, b).target_tangents.count, 0);
  // Nor does it matter for a mesh that has none itself.
  b.meshes[0].targets[0].tangents = moved;
  a.meshes[0].has_tangents = false;
  EXPECT_TRUE(compare_scenes(a, b).same());
}

// Two triangles side by side whose vertices on the common edge are double, as at a texture's seam:
// places and normals are the same, tangents are not.
Scene seam(bool swapped) {
  static const std::vector<Triangle> apart = {{0, 1, 2}, {3, 4, 5}};
  Scene scene = turning_square();
  scene.meshes[0].vertex_count = 6;
  scene.meshes[0].triangles = apart;
  scene.evaluate = [swapped](int, double time, SceneState& state) {
    state.positions = {{Vec3(-1, 0, time), Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, time),
                        Vec3(0, 1, 0), Vec3(0, 0, 0)}};
    state.normals = {std::vector<Vec3>(6, Vec3(0, 0, 1))};
    state.tangents = {{Vec4(1, 0, 0, 1), Vec4(1, 0, 0, 1), Vec4(1, 0, 0, 1), Vec4(-1, 0, 0, -1),
                       Vec4(-1, 0, 0, -1), Vec4(-1, 0, 0, -1)}};
    if (!swapped) return;
    std::rotate(state.positions[0].begin(), state.positions[0].begin() + 3,
                state.positions[0].end());
    std::rotate(state.tangents[0].begin(), state.tangents[0].begin() + 3, state.tangents[0].end());
  };
  return scene;
}

TEST(Tangents, NearestPointsAtATexturesSeamAreThoseOfTheirSide) {
  EXPECT_FALSE(compare_scenes(seam(false), seam(true)).same());
  const SceneDifference found = compare_scenes(seam(false), seam(true), Matching::nearest);
  EXPECT_TRUE(found.same());
  EXPECT_EQ(found.tangents.count, 2 * 6 * 60);
  EXPECT_EQ(found.tangents.largest, 0);
}

// Of a mesh beside one without tangents only, whose vertices on the edge are in the same places.
TEST(Tangents, NearestPointsAreTakenFromMeshesThatHaveThemToo) {
  Scene scene = seam(false);
  const std::vector<Triangle> one = {{0, 1, 2}};
  const auto split = [&](bool first_half_only) {
    Scene parts = scene;
    parts.meshes[0].vertex_count = 3;
    parts.meshes[0].triangles = one;
    parts.meshes.push_back(parts.meshes[0]);
    parts.meshes[1].name = "Hat";
    parts.meshes[1].has_tangents = !first_half_only;
    parts.evaluate = [whole = scene.evaluate](int animation, double time, SceneState& state) {
      SceneState all;
      whole(animation, time, all);
      const auto halves = [](const auto& values) {
        using Values = std::decay_t<decltype(values[0])>;
        return std::vector<Values>{{values[0].begin(), values[0].begin() + 3},
                                   {values[0].begin() + 3, values[0].end()}};
      };
      state.positions = halves(all.positions);
      state.normals = halves(all.normals);
      state.tangents = halves(all.tangents);
    };
    return parts;
  };
  const Scene half = split(true);
  const SceneDifference found = compare_scenes(half, half, Matching::nearest);
  EXPECT_TRUE(found.same());
  EXPECT_TRUE(found.notes.empty());
  EXPECT_EQ(found.tangents.count, 2 * 3 * 60);
  // One mesh against parts of which only one has them: that is said.
  const SceneDifference partly = compare_scenes(scene, half, Matching::nearest);
  ASSERT_EQ(partly.notes.size(), 2u);
  EXPECT_EQ(partly.notes[1],
            "mesh Body: 3 of its 6 nearest points have no tangents, so its tangents are not "
            "compared");
  EXPECT_EQ(partly.tangents.count, 3 * 60);  // those of the second's part
}

}  // namespace
}  // namespace krok::compare
