// If these fail, a mesh whose vertices stand in another order is said to differ, or one that
// differs is said to be the same.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "compare/mesh_difference.h"
#include "compare/nearest_triangle_internal.h"
#include "compare/scene_difference.h"
#include "unit/compare/compare_scenes.h"

namespace krok::compare {
namespace {

// The nearest point by looking at many points of the triangle.
double distance_by_sampling(const std::array<Vec3, 3>& triangle, const Vec3& point) {
  constexpr int kSteps = 200;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const double u = static_cast<double>(i) / kSteps;
      const double v = static_cast<double>(j) / kSteps;
      least = std::min(
          least, ((1 - u - v) * triangle[0] + u * triangle[1] + v * triangle[2] - point).norm());
    }
  }
  return least;
}

double distance_to(const std::array<Vec3, 3>& triangle, const Vec3& point) {
  const auto shares = nearest_shares(triangle, point);
  EXPECT_NEAR(shares[0] + shares[1] + shares[2], 1, 1e-12);
  EXPECT_GE(*std::min_element(shares.begin(), shares.end()), 0);
  return (shares[0] * triangle[0] + shares[1] * triangle[1] + shares[2] * triangle[2] - point)
      .norm();
}

TEST(NearestShares, IsAsNearAsThePointsOfTheTriangleCome) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-1, 1);
  const auto point = [&] { return Vec3(value(random), value(random), value(random)); };
  for (int i = 0; i < 200; ++i) {
    const std::array<Vec3, 3> triangle = {point(), point(), point()};
    const Vec3 from = 2 * point();
    const double sampled = distance_by_sampling(triangle, from);
    EXPECT_LE(distance_to(triangle, from), sampled + 1e-12);
    EXPECT_GE(distance_to(triangle, from), sampled - 0.02);
  }
}

TEST(NearestShares, TakesTrianglesWithoutAnArea) {
  const Vec3 a(0, 0, 0), b(2, 0, 0), middle(1, 0, 0);
  EXPECT_NEAR(distance_to({a, a, a}, Vec3(0, 3, 0)), 3, 1e-15);
  EXPECT_NEAR(distance_to({a, b, b}, Vec3(1.5, 3, 0)), 3, 1e-15);
  EXPECT_NEAR(distance_to({a, middle, b}, Vec3(1.5, 3, 0)), 3, 1e-15);
  EXPECT_NEAR(distance_to({b, middle, a}, Vec3(5, 4, 0)), 5, 1e-15);
  EXPECT_NEAR(distance_to({a, b, a}, Vec3(-3, 4, 0)), 5, 1e-15);
}

TEST(FacetTree, FindsTheNearestOfAll) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> value(-1, 1);
  const auto point = [&] { return Vec3(value(random), value(random), value(random)); };
  std::vector<Facet> facets;
  for (int i = 0; i < 500; ++i) {
    // Far from the origin, where floats are coarse.
    const Vec3 at = Vec3(1000, 0, 0) + 3 * point();
    facets.push_back({0, {}, {at + 0.2 * point(), at + 0.2 * point(), at + 0.2 * point()}});
  }
  const auto tree = FacetTree::create(facets);
  ASSERT_NE(tree, nullptr);
  std::vector<FoundFacet> found;
  for (int i = 0; i < 300; ++i) {
    const Vec3 from = Vec3(1000, 0, 0) + 4 * point();
    double least = std::numeric_limits<double>::infinity();
    for (const Facet& facet : facets) least = std::min(least, distance_to(facet.points, from));
    tree->find(from, found);
    ASSERT_FALSE(found.empty());
    double nearest = found.front().distance;
    for (const FoundFacet& one : found) nearest = std::min(nearest, one.distance);
    EXPECT_EQ(nearest, least);
  }
}

// A bumpy grid of (side + 1)^2 vertices that waves over time, as a scene of one mesh or more.
struct Grid {
  std::vector<Vec2> places;                      // [vertices]
  std::vector<std::vector<Triangle>> triangles;  // [meshes], numbers within the mesh
  std::vector<std::vector<int>> vertices;        // [meshes], places
};

Grid make_grid(int side = 12) {
  Grid grid;
  grid.triangles.resize(1);
  grid.vertices.resize(1);
  const auto at = [side](int x, int y) { return static_cast<std::uint32_t>(y * (side + 1) + x); };
  for (int y = 0; y <= side; ++y) {
    for (int x = 0; x <= side; ++x) {
      grid.vertices[0].push_back(static_cast<int>(grid.places.size()));
      grid.places.emplace_back(x, y);
      if (x == side || y == side) continue;
      grid.triangles[0].push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      grid.triangles[0].push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return grid;
}

Vec3 position_of(const Vec2& place, double time) {
  return {0.1 * place.x(), 0.1 * place.y(),
          0.05 * std::sin(place.x() + 3 * time) * std::cos(0.7 * place.y())};
}

using Change = std::function<void(double time, SceneState& state)>;

Scene scene_of(const Grid& grid, const Change& change = {}) {
  Scene scene;
  for (std::size_t m = 0; m < grid.triangles.size(); ++m) {
    SceneMesh mesh;
    mesh.name = grid.triangles.size() == 1 ? "" : std::string("part ") + std::to_string(m);
    mesh.vertex_count = grid.vertices[m].size();
    mesh.has_normals = true;
    mesh.triangles = grid.triangles[m];
    scene.meshes.push_back(mesh);
  }
  scene.animations.push_back({"", {0, 0.25, 0.5, 0.75, 1}});
  scene.evaluate = [&grid, change](int, double time, SceneState& state) {
    state.positions.assign(grid.triangles.size(), {});
    state.normals.assign(grid.triangles.size(), {});
    state.joints.clear();
    for (std::size_t m = 0; m < grid.triangles.size(); ++m) {
      for (const int v : grid.vertices[m]) {
        const Vec2& place = grid.places[static_cast<std::size_t>(v)];
        state.positions[m].push_back(position_of(place, time));
        state.normals[m].push_back(Vec3(0.1 * place.x(), std::sin(time), 1).normalized());
      }
    }
    if (change) change(time, state);
  };
  return scene;
}

// Vertices in another order, triangles too, each beginning at another corner.
Grid shuffled(const Grid& grid, unsigned seed) {
  std::mt19937 random(seed);
  Grid other = grid;
  std::vector<std::uint32_t> order(grid.vertices[0].size());
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), random);
  for (std::size_t v = 0; v < order.size(); ++v) {
    other.vertices[0][order[v]] = grid.vertices[0][v];
  }
  for (Triangle& t : other.triangles[0]) {
    t = {order[t[1]], order[t[2]], order[t[0]]};
  }
  std::shuffle(other.triangles[0].begin(), other.triangles[0].end(), random);
  return other;
}

// Each triangle with three vertices of its own.
Grid exploded(const Grid& grid) {
  Grid other = grid;
  other.vertices[0].clear();
  for (Triangle& t : other.triangles[0]) {
    for (std::uint32_t& corner : t) {
      other.vertices[0].push_back(grid.vertices[0][corner]);
      corner = static_cast<std::uint32_t>(other.vertices[0].size() - 1);
    }
  }
  return other;
}

// Triangles dealt out to two meshes.
Grid in_two_parts(const Grid& grid) {
  Grid other;
  other.places = grid.places;
  other.triangles.resize(2);
  other.vertices.resize(2);
  for (std::size_t m = 0; m < 2; ++m) {
    std::map<std::uint32_t, std::uint32_t> number;
    for (std::size_t i = m; i < grid.triangles[0].size(); i += 2) {
      Triangle t = grid.triangles[0][i];
      for (std::uint32_t& corner : t) {
        const auto [found, is_new] =
            number.emplace(corner, static_cast<std::uint32_t>(other.vertices[m].size()));
        if (is_new) other.vertices[m].push_back(grid.vertices[0][corner]);
        corner = found->second;
      }
      other.triangles[m].push_back(t);
    }
  }
  return other;
}

SceneDifference compare_by_place(const Scene& a, const Scene& b, int jobs = 1) {
  Progress progress;
  SceneOptions options;
  options.matching = Matching::nearest;
  options.keep_vertices = true;
  const auto found = difference(a, b, options, jobs, progress);
  EXPECT_TRUE(found.ok()) << found.error().message;
  return found.ok() ? *found : SceneDifference();
}

TEST(Nearest, AReorderedMeshIsTheSame) {
  const Grid grid = make_grid();
  for (const unsigned seed : {1u, 2u}) {
    const Grid other = shuffled(grid, seed);
    EXPECT_FALSE(compare_scenes(scene_of(grid), scene_of(other)).same());
    const SceneDifference found = compare_by_place(scene_of(grid), scene_of(other));
    EXPECT_TRUE(found.same());
    EXPECT_TRUE(found.structure.empty());
    EXPECT_LT(found.positions.largest, 1e-12);
    EXPECT_LT(found.normals.largest, 1e-7);
    EXPECT_EQ(found.positions.count, 2 * 5 * 169);  // both ways
  }
}

TEST(Nearest, VerticesSplitAtSeamsAndOtherPartsAreTheSame) {
  const Grid grid = make_grid();
  const Grid split = exploded(grid);
  const Grid parts = in_two_parts(grid);
  const SceneDifference seams = compare_by_place(scene_of(grid), scene_of(split));
  EXPECT_TRUE(seams.same());
  EXPECT_EQ(seams.notes.size(), 1u);
  EXPECT_TRUE(compare_by_place(scene_of(split), scene_of(grid)).same());
  EXPECT_TRUE(compare_by_place(scene_of(grid), scene_of(parts)).same());
  EXPECT_TRUE(compare_by_place(scene_of(parts), scene_of(split)).same());
}

TEST(Nearest, AVertexThatMovesLaterIsFoundAndNamed) {
  const Grid grid = make_grid();
  const Grid other = shuffled(grid, 3);
  const Change lift = [](double time, SceneState& state) {
    if (time == 0.5) state.positions[0][7].z() += 1e-4;
  };
  for (const int jobs : {1, 3}) {
    const SceneDifference first = compare_by_place(scene_of(grid, lift), scene_of(other), jobs);
    EXPECT_FALSE(first.same());
    EXPECT_NEAR(first.positions.largest, 1e-4, 1e-12);
    EXPECT_EQ(first.positions.where.frame, 2);
    EXPECT_EQ(first.positions.where.vertex, 7);
    EXPECT_FALSE(first.positions.where.in_second);
    EXPECT_FLOAT_EQ(first.vertex_largest[0][7], 1e-4F);
    EXPECT_EQ(first.vertex_largest[0][8], 0.0F);
  }
  const SceneDifference second = compare_by_place(scene_of(other), scene_of(grid, lift));
  EXPECT_NEAR(second.positions.largest, 1e-4, 1e-12);
  // Its partner in the first is told first.
  EXPECT_EQ(other.vertices[0][static_cast<std::size_t>(second.positions.where.vertex)], 7);
}

TEST(Nearest, WhatOnlyTheSecondHasIsFoundToo) {
  const Grid grid = make_grid(4);
  const Grid larger = make_grid(6);
  const SceneDifference found = compare_by_place(scene_of(grid), scene_of(larger));
  EXPECT_FALSE(found.same());
  EXPECT_TRUE(found.positions.where.in_second);
  ASSERT_EQ(found.parts.size(), 2u);
  EXPECT_TRUE(found.parts[0].positions.within());
  EXPECT_TRUE(found.parts[1].in_second);
  EXPECT_GT(found.parts[1].positions.largest, 0.2);
}

// Two squares that lie on each other at first and part later: lips that open.
TEST(Nearest, SurfacesThatTouchAtFirstAreToldApart) {
  Grid lips;
  lips.places = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  lips.vertices = {{0, 1, 2, 3, 0, 1, 2, 3}};
  lips.triangles = {{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}};
  Grid swapped = lips;
  swapped.triangles = {{{4, 5, 6}, {4, 6, 7}, {0, 1, 2}, {0, 2, 3}}};
  const auto open = [](std::size_t upper) {
    return [upper](double time, SceneState& state) {
      for (std::size_t v = upper; v < upper + 4; ++v) state.positions[0][v].z() += 0.1 * time;
    };
  };
  EXPECT_TRUE(compare_by_place(scene_of(lips, open(4)), scene_of(swapped, open(0))).same());
  EXPECT_FALSE(compare_by_place(scene_of(lips, open(4)), scene_of(swapped)).same());
}

TEST(Nearest, AMeshThatUnfoldsFromOnePointIsToldApart) {
  const Grid grid = make_grid();
  const Grid other = shuffled(grid, 4);
  const Change folded = [](double time, SceneState& state) {
    for (Vec3& position : state.positions[0]) position *= time;
  };
  EXPECT_TRUE(compare_by_place(scene_of(grid, folded), scene_of(other, folded)).same());
}

TEST(Nearest, NormalsTellEdgesApart) {
  // Two triangles at a right angle, with the normals of their sides along the edge.
  Grid edge;
  edge.places = {{0, 0}, {1, 0}, {0, 1}};
  edge.vertices = {{0, 1, 2, 0, 1, 2}};
  edge.triangles = {{{0, 1, 2}, {3, 4, 5}}};
  Grid other = edge;
  other.triangles = {{{5, 3, 4}, {2, 0, 1}}};
  const auto fold = [](std::size_t side) {
    return [side](double, SceneState& state) {
      state.positions[0][side + 2] = Vec3(0, 0, 1);
      for (std::size_t v = side; v < side + 3; ++v) state.normals[0][v] = Vec3(0, -1, 0);
    };
  };
  const SceneDifference found = compare_by_place(scene_of(edge, fold(0)), scene_of(other, fold(3)));
  EXPECT_TRUE(found.same());
  EXPECT_GT(found.normals.count, 0);
}

// A cube of split vertices, and the same with each vertex moved by up to `off`, the faces in
// reverse order: what quantising and reordering do.
Scene cube(double off, bool other) {
  static const auto triangles = [] {
    std::array<std::vector<Triangle>, 2> lists;
    for (std::uint32_t face = 0; face < 6; ++face) {
      const std::uint32_t v = 4 * face;
      lists[0].push_back({v, v + 1, v + 2});
      lists[0].push_back({v, v + 2, v + 3});
    }
    lists[1].assign(lists[0].rbegin(), lists[0].rend());
    return lists;
  }();
  std::vector<Vec3> positions, normals;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-off, off);
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const double side = face % 2 == 0 ? 1 : -1;
    for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
      Vec3 place = Vec3::Zero(), normal = Vec3::Zero();
      place[axis] = side;
      place[(axis + 1) % 3] = side * x;
      place[(axis + 2) % 3] = y;
      normal[axis] = side;
      positions.push_back(place + Vec3(shift(random), shift(random), shift(random)));
      normals.push_back(normal);
    }
  }
  Scene scene;
  SceneMesh mesh;
  mesh.vertex_count = positions.size();
  mesh.has_normals = true;
  mesh.triangles = triangles[other ? 1 : 0];
  scene.meshes.push_back(mesh);
  scene.evaluate = [positions, normals](int, double, SceneState& state) {
    state.positions = {positions};
    state.normals = {normals};
  };
  return scene;
}

// Would fail if a vertex took the normal of the face that happens to be nearest by a hair. The
// shift is within the tolerance of 0.1 mm, or beyond that of 0.01 mm, where the normals still fit.
TEST(Nearest, NormalsAtHardEdgesAreThoseOfTheRightFace) {
  for (const double tolerance : {1e-4, 1e-5}) {
    Progress progress;
    SceneOptions options;
    options.matching = Matching::nearest;
    options.tolerance.length = tolerance;
    const auto found = difference(cube(0, false), cube(5e-5, true), options, 1, progress);
    ASSERT_TRUE(found.ok());
    EXPECT_LT(found->normals.largest, 1e-6) << tolerance;
    EXPECT_LT(found->positions.largest, 1e-4);
    EXPECT_EQ(found->positions.within(), tolerance > 5e-5);
    EXPECT_TRUE(found->structure.empty());
  }
}

// Each vertex is still touched by a triangle: only the insides of triangles show what is missing.
TEST(Nearest, FindsOneTriangleThatIsMissingOrRewired) {
  const Grid grid = make_grid();
  for (const bool rewired : {false, true}) {
    Grid other = shuffled(grid, 3);
    auto& triangles = other.triangles[0];
    if (rewired) {
      triangles[100][2] = triangles[7][0];
    } else {
      triangles.erase(triangles.begin() + 100);
    }
    for (const bool swapped : {false, true}) {
      const Scene a = scene_of(grid), b = scene_of(other);
      const SceneDifference found = swapped ? compare_by_place(b, a) : compare_by_place(a, b);
      EXPECT_FALSE(found.same()) << rewired << swapped;
      EXPECT_TRUE(found.positions.within());
      ASSERT_FALSE(found.structure.empty());
      EXPECT_NE(found.structure[0].find("1 of its "), std::string::npos) << found.structure[0];
    }
  }
}

// Two sheets on joints of their own, which touch at the times that are looked at first and part in
// between: a vertex belongs to the sheet that hangs on its joint.
TEST(Nearest, PrefersWhatHangsOnTheSameJoints) {
  const Grid grid = make_grid();
  const auto vertices = static_cast<std::uint32_t>(grid.vertices[0].size());
  Grid both = grid;
  for (std::uint32_t v = 0; v < vertices; ++v) both.vertices[0].push_back(grid.vertices[0][v]);
  for (const Triangle& t : grid.triangles[0]) {
    both.triangles[0].push_back({t[0] + vertices, t[1] + vertices, t[2] + vertices});
  }
  std::vector<std::uint16_t> joints(2 * vertices, 0);
  std::fill(joints.begin() + vertices, joints.end(), std::uint16_t{1});
  const std::vector<float> weights(2 * vertices, 1.0F);
  const auto with_joints = [&](double shift) {
    Scene scene = scene_of(both, [vertices, shift](double time, SceneState& state) {
      const bool apart = std::abs(time - 0.03) < 1e-9;
      for (std::uint32_t v = 0; v < 2 * vertices; ++v) {
        state.positions[0][v].z() += shift + (v < vertices ? 0 : apart ? 0.3 : 0.0004);
      }
      state.joints = {{}, {}};
    });
    scene.animations[0].key_times.clear();
    for (int k = 0; k <= 100; ++k) scene.animations[0].key_times.push_back(0.01 * k);
    scene.joint_names = {"Trunk", "Arm"};
    scene.joint_parents = {-1, 0};
    scene.meshes[0].influences = {1, joints, weights};
    return scene;
  };
  // Moved by half of what the sheets are apart, so that the other one is as near.
  const SceneDifference found = compare_by_place(with_joints(0), with_joints(0.0003));
  EXPECT_LT(found.positions.largest, 0.0004);
}

TEST(Nearest, APointCloudIsHeldAgainstASurface) {
  const Grid grid = make_grid();
  Scene points = scene_of(grid);
  points.meshes[0].triangles = {};
  points.meshes[0].has_normals = false;
  points.meshes[0].only_points = true;
  points.evaluate = [plain = points.evaluate](int animation, double time, SceneState& state) {
    plain(animation, time, state);
    state.normals[0].clear();
  };
  const SceneDifference found = compare_by_place(scene_of(grid), points);
  EXPECT_TRUE(found.same());
  EXPECT_EQ(found.normals.count, 0);
}

// Triangles that became lines or points. Would fail if a surface that vanishes were the same.
TEST(Nearest, ASurfaceThatIsGoneIsADifference) {
  const Grid grid = make_grid();
  Scene lines = scene_of(grid);
  lines.meshes[0].triangles = {};
  EXPECT_FALSE(compare_by_place(scene_of(grid), lines).same());
  EXPECT_FALSE(compare_by_place(lines, scene_of(grid)).same());
}

// Two sheets 0.016 mm apart, 30 m in size. Would fail if what is nearly as near as the nearest,
// which a large scene has more of, were a hole.
TEST(Nearest, InALargeSceneTheNearestCounts) {
  const Grid grid = in_two_parts(make_grid());
  const Change sheets = [](double, SceneState& state) {
    for (std::size_t m = 0; m < state.positions.size(); ++m) {
      for (Vec3& place : state.positions[m]) {
        place *= 30;
        if (m == 1) place.z() += 1.6e-5;
      }
    }
  };
  EXPECT_TRUE(compare_by_place(scene_of(grid, sheets), scene_of(grid, sheets)).same());
}

// Names that a program gave anew, shifted by one. Would fail if meshes were paired by a name
// although others alone have as many vertices.
TEST(MatchedMeshes, AreThoseOfTheSameSizeWhereNamesAreShifted) {
  Grid grid = in_two_parts(make_grid());
  grid.triangles[1].pop_back();
  grid.vertices[1].push_back(grid.vertices[1].front());
  Scene first = scene_of(grid), second = scene_of(grid);
  first.meshes[0].name = "Mesh.001";
  first.meshes[1].name = "Mesh.002";
  second.meshes[0].name = "Mesh.002";
  second.meshes[1].name = "Mesh.003";
  const SceneDifference found = compare_scenes(first, second);
  EXPECT_TRUE(found.same()) << found.structure.size();
}

TEST(Nearest, NothingToCompareWithIsADifference) {
  const Grid grid = make_grid(2);
  Scene none;
  none.animations.push_back({"", {0, 1}});
  none.evaluate = [](int, double, SceneState& state) { state = {}; };
  EXPECT_FALSE(compare_by_place(scene_of(grid), none).same());
  Scene empty = none;
  empty.meshes.emplace_back();
  empty.evaluate = [](int, double, SceneState& state) {
    state.positions.assign(1, {});
    state.normals.assign(1, {});
    state.joints.clear();
  };
  EXPECT_FALSE(compare_by_place(scene_of(grid), empty).same());
  EXPECT_TRUE(compare_by_place(empty, empty).same());
}

}  // namespace
}  // namespace krok::compare
