// The lattice under a body: if these fail, bodies get handles between fingers or lose parts of
// their surface.

#include <cmath>

#include "body/lattice.h"
#include "body/polygonise.h"
#include "body/shapes.h"
#include "support/human_skeleton.h"
#include "unit/body/mesh_checks.h"

namespace krok::body {
namespace {

// A tube around a circle of 1 m, but for `gap` of its eight stations.
Shape ring(int gap) {
  Tube tube;
  for (int i = 0; i <= 8 - gap; ++i) {
    const double turn = i * kPi / 4;
    Station station;
    station.center = Vec3(std::cos(turn), std::sin(turn), 0);
    station.width = station.depth = station.cap = 0.2;
    tube.stations.push_back(station);
  }
  tube.joints = {{0, 0, 0}};
  tube.spline = false;
  Shape shape;
  shape.add(std::move(tube));
  return shape;
}

struct Marched {
  explicit Marched(const Shape& shape, double cell) : field(shape), blocked(field, cell, 1) {}
  Field field;
  BlockedField blocked;
};

TEST(Lattice, ARingBecomesABallAndKeepsItsShape) {
  const Marched marched(ring(0), 0.05);
  Lattice lattice(marched.blocked, 1);
  const Mesh before = polygonise(lattice, 1);
  EXPECT_FALSE(is_sphere(before));
  EXPECT_EQ(before.positions.size(), before.triangles.size() / 2);  // one handle
  lattice.make_ball();
  const Mesh after = polygonise(lattice, 1);
  EXPECT_TRUE(is_sphere(after));
  EXPECT_NEAR(signed_volume(after) / signed_volume(before), 1, 0.04);
}

TEST(Lattice, ABallStaysAsItIs) {
  const Marched marched(ring(2), 0.05);
  Lattice lattice(marched.blocked, 1);
  const Mesh before = polygonise(lattice, 1);
  EXPECT_TRUE(is_sphere(before));
  lattice.make_ball();
  const Mesh after = polygonise(lattice, 1);
  EXPECT_EQ(before.triangles, after.triangles);
  EXPECT_EQ(before.positions, after.positions);
}

TEST(Lattice, PiecesApartBecomeOne) {
  Shape shape = ring(2);
  Shape other = ring(5);
  for (Station& station : other.tubes[0].stations) station.center.z() += 1;
  shape.add(std::move(other.tubes[0]));
  const Marched marched(shape, 0.05);
  Lattice lattice(marched.blocked, 1);
  EXPECT_FALSE(is_sphere(polygonise(lattice, 1)));
  lattice.make_ball();
  EXPECT_TRUE(is_sphere(polygonise(lattice, 1)));
}

TEST(Lattice, KnowsInsideFromOutsideWhereItSkips) {
  const Skeleton skeleton = test::human_skeleton();
  const auto actor = find_human(skeleton, find_roles(skeleton));
  ASSERT_TRUE(actor.has_value());
  const Marched marched(human_shape(skeleton, *actor, skeleton.reference), 0.008);
  const Lattice lattice(marched.blocked, 0);
  Lattice::Cubes values;
  std::size_t wrong = 0, inexact = 0;
  for (std::size_t b = 0; b < marched.blocked.blocks().size(); ++b) {
    if (!lattice.cubes(b, values)) continue;
    const auto& [corner, near] = marched.blocked.blocks()[b];
    std::size_t i = 0;
    for (int z = 0; z < Lattice::kSide; ++z) {
      for (int y = 0; y < Lattice::kSide; ++y) {
        for (int x = 0; x < Lattice::kSide; ++x, ++i) {
          const double exact = marched.field.value(
              marched.blocked.lattice_point(corner[0] + x, corner[1] + y, corner[2] + z), near);
          if ((exact < 0) != (values[i] < 0)) ++wrong;
          // Next to the surface the values themselves matter.
          if (std::abs(exact) < marched.blocked.cell() && std::abs(exact - values[i]) > 1e-9) {
            ++inexact;
          }
        }
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(inexact, 0u);
}

}  // namespace
}  // namespace krok::body
