// If these fail, bodies sink over the edges of steps, hang beside them in the air, or fall
// otherwise on the same ground when it is turned, moved or cut into other triangles.

#include "ragdoll/ground_edges_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/index.h"
#include "math/quaternion.h"
#include "ragdoll/world.h"

namespace krok::ragdoll {
namespace {

using Triangles = std::vector<std::array<Vec3, 3>>;

constexpr double kRise = 0.2;

// A parallelogram, cut into 2 * cuts * cuts triangles.
void add_face(const Vec3& corner, const Vec3& u, const Vec3& v, int cuts, Triangles& triangles) {
  const auto point = [&](int a, int b) {
    return Vec3(corner + (static_cast<double>(a) / cuts) * u + (static_cast<double>(b) / cuts) * v);
  };
  for (int a = 0; a < cuts; ++a) {
    for (int b = 0; b < cuts; ++b) {
      triangles.push_back({point(a, b), point(a, b + 1), point(a + 1, b)});
      triangles.push_back({point(a + 1, b), point(a, b + 1), point(a + 1, b + 1)});
    }
  }
}

// Two levels of 4 x 2 m with a wall between them at z = 0; the lower one lies at z > 0.
Triangles one_step(int cuts, const Transform& place = {}) {
  Triangles triangles;
  add_face({-2, kRise, -2}, {4, 0, 0}, {0, 0, 2}, cuts, triangles);
  add_face({-2, 0, 0}, {4, 0, 0}, {0, 0, 2}, cuts, triangles);
  add_face({-2, 0, 0}, {4, 0, 0}, {0, kRise, 0}, cuts, triangles);
  for (auto& triangle : triangles) {
    for (Vec3& corner : triangle) corner = place * corner;
  }
  return triangles;
}

// The edge of the step; the others are the rims of both levels.
GroundEdge nose(const GroundEdges& edges) {
  for (std::size_t e = 0; e < edges.count(); ++e) {
    const GroundEdge& edge = edges[static_cast<int>(e)];
    const Vec3 middle = edge.begin + 0.5 * edge.length * edge.along;
    if ((middle - Vec3(0, kRise, 0)).norm() < 1e-6) return edge;
  }
  ADD_FAILURE() << "the step has no edge";
  return {};
}

TEST(GroundEdges, AreTheSameHoweverTheFacesAreCut) {
  for (const int cuts : {1, 2, 7}) {
    Triangles triangles = one_step(cuts);
    // The order of a triangle's corners says nothing of where the ground is.
    for (std::size_t t = 0; t < triangles.size(); t += 2)
      std::swap(triangles[t][0], triangles[t][1]);
    const GroundEdges edges(triangles);
    EXPECT_EQ(edges.count(), 7U) << cuts;  // the step's, and three of each level's rim
    const GroundEdge edge = nose(edges);
    EXPECT_NEAR(edge.length, 4, 1e-9);
    EXPECT_NEAR(std::abs(edge.along.x()), 1, 1e-9);
    const bool up_first = edge.first.y() > 0.5;
    EXPECT_NEAR((up_first ? edge.first : edge.second).y(), 1, 1e-9);
    EXPECT_NEAR((up_first ? edge.second : edge.first).z(), 1, 1e-9);
  }
}

// From a point to the nearest one of a shape's core: the box, or the capsule's middle line.
Vec3 way_to(const Shape& shape, const Transform& pose, const Vec3& point) {
  const bool box = shape.kind == Shape::Kind::box;
  const Vec3 half = box ? shape.half : Vec3(0, shape.half_length, 0);
  const Vec3 local = pose.inverse() * point;
  return pose.orientation * Vec3(local.cwiseMin(half).cwiseMax(-half) - local);
}

// From the edge to a shape that is apart from it. The distance from a point of the edge is a convex
// function of where it is, so thirds find its minimum.
Vec3 way_to(const Shape& shape, const Transform& pose, const GroundEdge& edge) {
  const auto way = [&](double s) { return way_to(shape, pose, edge.begin + s * edge.along); };
  double low = 0, high = edge.length;
  for (int i = 0; i < 60; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (way(a).norm() < way(b).norm() ? high : low) = way(a).norm() < way(b).norm() ? b : a;
  }
  return way(0.5 * (low + high));
}

// A shape near an edge touches it at the distance that it has, in the direction in which it is out.
TEST(GroundEdges, TouchesAreAsFarAsTheShapesAre) {
  const GroundEdge edge = nose(GroundEdges(one_step(1)));
  std::mt19937 random(3);
  const auto share = [&] { return random() / 4294967296.0; };
  int touched = 0;
  for (int i = 0; i < 2500; ++i) {
    Shape shape;
    shape.kind = i % 2 == 0 ? Shape::Kind::box : Shape::Kind::capsule;
    shape.half = Vec3(0.05, 0.05, 0.05) + 0.2 * Vec3(share(), share(), share());
    shape.radius = 0.03 + 0.1 * share();
    shape.half_length = 0.3 * share();
    Transform pose;
    pose.orientation =
        Quat(share() - 0.5, share() - 0.5, share() - 0.5, share() - 0.5).normalized();
    pose.position = Vec3(share() - 0.5, kRise + 0.5 * share(), 0.5 * share());
    const Vec3 way = way_to(shape, pose, edge), out = way.normalized();
    const double apart = way.norm() - (shape.kind == Shape::Kind::box ? 0 : shape.radius);
    if (!(apart > 1e-4)) continue;
    // Moved there by the shortest way, it is that near.
    const double distance = 1e-4 + 0.0198 * share();
    pose.position -= (apart - distance) * out;
    if (out.y() < 0.12 || out.z() < 0.12) continue;  // nearer to a side of the edge, which meets it
    std::vector<EdgeTouch> touches;
    touch_edge(shape, pose, edge, 0.02, touches);
    ASSERT_FALSE(touches.empty()) << i;
    ++touched;
    double least = 1;
    for (const EdgeTouch& touch : touches) {
      least = std::min(least, touch.gap);
      EXPECT_NEAR(touch.normal.norm(), 1, 1e-9);
      EXPECT_GE(touch.normal.y(), -0.03);
      EXPECT_GE(touch.normal.z(), -0.03);
    }
    EXPECT_NEAR(least, distance, 1e-3) << i;
  }
  EXPECT_GT(touched, 500);
}

// Where a box and a capsule that are dropped onto the edge of a step are after a second.
std::vector<Transform> dropped(const Triangles& triangles, const Transform& place) {
  std::vector<Transform> ends;
  for (const auto kind : {Shape::Kind::box, Shape::Kind::capsule}) {
    Body body;
    body.name = "dropped";
    body.mass = 5;
    body.shape.kind = kind;
    body.shape.half = Vec3(0.3, 0.06, 0.1);
    body.shape.radius = 0.08;
    body.shape.half_length = 0.2;
    BodyState state;
    const Quat lying = from_rotation_vector(Vec3(0, 0, kind == Shape::Kind::box ? 0 : kPi / 2));
    state.to_world = place * Transform{Vec3(0.1, kRise + 0.2, 0.03), lying};
    Surroundings ground;
    ground.triangles = triangles;
    World world({}, ground);
    EXPECT_TRUE(world.add(std::vector{body}, std::vector{state}, {}).ok());
    for (int step = 0; step < 240; ++step) world.step();
    EXPECT_LT(world.measures().penetration, 0.005);
    ends.push_back(place.inverse() * world.state(0).to_world);
  }
  return ends;
}

// The same fall on ground that is cut otherwise, turned, and moved (Bullet holds triangles in
// single precision: 30 m away they are 2e-6 m off).
TEST(GroundEdges, HowTheGroundIsDescribedDoesNotMatter) {
  const std::vector<Transform> plain = dropped(one_step(1), {});
  for (const Transform& end : plain) EXPECT_LT(end.position.y(), kRise);  // it slid off
  const Transform turn{Vec3(30, 1, -20), from_rotation_vector(Vec3(0, 2.1, 0))};
  const std::vector<Transform> cut = dropped(one_step(5), {}),
                               moved = dropped(one_step(1, turn), turn);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_LT((cut[i].position - plain[i].position).norm(), 0.01) << i;
    EXPECT_LT((moved[i].position - plain[i].position).norm(), 0.01) << i;
  }
}

}  // namespace
}  // namespace krok::ragdoll
