// If these fail, a key-frame mesh has another shape between its keys than the formula says, is not
// exactly its key at a key's time, or is made of keys that cannot be.

#include "skin/key_frame_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/hermite.h"

namespace krok {
namespace {

constexpr int kMeshVertices = 3000;  // more than one tile

Vec3f place(int vertex, double time) {
  const double way = 0.3 + 0.001 * vertex;
  return Vec3(way * time, std::sin(0.1 * vertex), time * time * way).cast<float>();
}

// Each vertex goes along a parabola of its own; normals turn about z by `time`.
KeyFrameMesh parabolas(const std::vector<double>& times) {
  KeyFrameMesh mesh;
  mesh.times = times;
  mesh.vertex_count = kMeshVertices;
  for (const double time : times) {
    for (int v = 0; v < kMeshVertices; ++v) {
      mesh.positions.push_back(place(v, time));
      mesh.normals.push_back(Vec3(std::cos(time), std::sin(time), 0).cast<float>());
    }
  }
  return mesh;
}

struct Shape {
  std::vector<Vec3f> positions = std::vector<Vec3f>(kMeshVertices);
  std::vector<Vec3f> normals = std::vector<Vec3f>(kMeshVertices);
};

Shape shape(const KeyFrameMesh& mesh, ShapeJoin join, double tension, double time, int jobs = 1) {
  Shape result;
  shape_at(mesh, join, tension, time, {result.positions, result.normals}, jobs);
  return result;
}

TEST(KeyFrameMesh, AKeyIsItselfToTheBit) {
  const KeyFrameMesh mesh = parabolas({0, 0.25, 1, 1.5});
  for (const ShapeJoin join : {ShapeJoin::linear, ShapeJoin::hermite}) {
    for (int key = 0; key < mesh.key_count(); ++key) {
      const Shape found = shape(mesh, join, 0.3, mesh.times[static_cast<std::size_t>(key)]);
      for (std::size_t v = 0; v < kMeshVertices; ++v) {
        const std::size_t at = static_cast<std::size_t>(key) * kMeshVertices + v;
        ASSERT_EQ(found.positions[v], mesh.positions[at]);
        ASSERT_EQ(found.normals[v], mesh.normals[at]);
      }
    }
  }
}

TEST(KeyFrameMesh, LinearIsTheChord) {
  const KeyFrameMesh mesh = parabolas({0, 1, 4});
  const Shape found = shape(mesh, ShapeJoin::linear, 0, 1.75);
  for (int v = 0; v < kMeshVertices; ++v) {
    const Vec3 expected = 0.75 * place(v, 1).cast<double>() + 0.25 * place(v, 4).cast<double>();
    ASSERT_LT((found.positions[static_cast<std::size_t>(v)].cast<double>() - expected).norm(),
              1e-5);
  }
}

// With even keys and a = 0 the tangents are central differences, which are exact for parabolas.
TEST(KeyFrameMesh, HermiteFollowsAParabola) {
  const KeyFrameMesh mesh = parabolas({0, 0.5, 1, 1.5, 2});
  for (const double time : {0.6, 0.75, 1.1, 1.49}) {
    const Shape found = shape(mesh, ShapeJoin::hermite, 0, time);
    const Shape straight = shape(mesh, ShapeJoin::linear, 0, time);
    double off = 0, straight_off = 0;
    for (int v = 0; v < kMeshVertices; ++v) {
      const auto at = static_cast<std::size_t>(v);
      const Vec3f expected = place(v, time);
      off = std::max<double>(off, (found.positions[at] - expected).norm());
      straight_off = std::max<double>(straight_off, (straight.positions[at] - expected).norm());
    }
    EXPECT_LT(off, 2e-6) << time;
    EXPECT_GT(straight_off, 1e-3) << time;
  }
}

// The formula of the source, written out: p(t) with m_i = (1 - a) / 2 ((p_i - p_{i-1}) + (p_{i+1} -
// p_i)) for even keys, and the one difference at the ends.
TEST(KeyFrameMesh, HermiteIsTheSourcesFormula) {
  const std::vector<double> values = {3, -1, 2, 5};
  const double a = 0.4;
  const auto tangent = [&](std::size_t i) {
    const double before = i > 0 ? values[i] - values[i - 1] : values[1] - values[0];
    const double after = i < 3 ? values[i + 1] - values[i] : values[3] - values[2];
    return (1 - a) / 2 * (before + after);
  };
  KeyFrameMesh mesh;
  mesh.times = {0, 1, 2, 3};
  mesh.vertex_count = 1;
  for (const double value : values) mesh.positions.emplace_back(static_cast<float>(value), 0, 0);
  std::vector<Vec3f> out(1);
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double t : {0.2, 0.5, 0.9}) {
      const double t2 = t * t, t3 = t2 * t;
      const double expected = (2 * t3 - 3 * t2 + 1) * values[i] + (t3 - 2 * t2 + t) * tangent(i) +
                              (-2 * t3 + 3 * t2) * values[i + 1] + (t3 - t2) * tangent(i + 1);
      shape_at(mesh, ShapeJoin::hermite, a, static_cast<double>(i) + t, {out, {}});
      EXPECT_NEAR(out[0].x(), expected, 1e-6) << i << " " << t;
    }
  }
}

TEST(KeyFrameMesh, UnevenKeysKeepTheVelocity) {
  // What moves evenly goes on evenly, however uneven the keys are.
  const std::vector<double> times = {0, 0.1, 1, 1.3, 4};
  for (const double time : {0.05, 0.5, 1.2, 3.0}) {
    const KeyShares shares = shares_at(times, ShapeJoin::hermite, 0, time);
    double sum = 0, moved = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(shares.count); ++i) {
      sum += shares.shares[i];
      moved += shares.shares[i] * times[static_cast<std::size_t>(shares.keys[i])];
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_NEAR(moved, time, 1e-14);
  }
  // And the curve is that of lib/math, which is held against other programs.
  const std::vector<double> values = {1, 5, -2, 0, 3};
  std::vector<double> velocities(values.size());
  tension_velocities(times, values, 0.25, Ends::open, velocities);
  for (double time = 0; time <= 4; time += 0.0625) {
    const KeyShares shares = shares_at(times, ShapeJoin::hermite, 0.25, time);
    double found = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(shares.count); ++i) {
      found += shares.shares[i] * values[static_cast<std::size_t>(shares.keys[i])];
    }
    EXPECT_NEAR(found, sample_curve(times, values, velocities, time), 1e-12) << time;
  }
}

TEST(KeyFrameMesh, FullTensionEasesBetweenTwoKeysAlone) {
  const std::vector<double> times = {0, 2, 3, 7};
  for (double t = 0.1; t < 1; t += 0.1) {
    const KeyShares shares = shares_at(times, ShapeJoin::hermite, 1, 3 + 4 * t);
    for (std::size_t i = 0; i < static_cast<std::size_t>(shares.count); ++i) {
      const double expected = shares.keys[i] == 2   ? 1 - t * t * (3 - 2 * t)
                              : shares.keys[i] == 3 ? t * t * (3 - 2 * t)
                                                    : 0;
      EXPECT_NEAR(shares.shares[i], expected, 1e-14);
    }
  }
}

TEST(KeyFrameMesh, NormalsHaveLengthOne) {
  const KeyFrameMesh mesh = parabolas({0, 1, 2});
  for (const ShapeJoin join : {ShapeJoin::linear, ShapeJoin::hermite}) {
    const Shape found = shape(mesh, join, 0, 0.5);
    EXPECT_NEAR(found.normals[7].norm(), 1, 1e-6);
  }
  // Halfway between two directions.
  EXPECT_NEAR(std::atan2(shape(mesh, ShapeJoin::linear, 0, 1.5).normals[0].y(),
                         shape(mesh, ShapeJoin::linear, 0, 1.5).normals[0].x()),
              1.5, 1e-6);
}

TEST(KeyFrameMesh, OppositeNormalsStayThoseOfAKey) {
  KeyFrameMesh mesh;
  mesh.times = {0, 1};
  mesh.vertex_count = 1;
  mesh.positions = {Vec3f::Zero(), Vec3f::UnitX()};
  mesh.normals = {Vec3f::UnitY(), -Vec3f::UnitY()};
  std::vector<Vec3f> positions(1), normals(1);
  shape_at(mesh, ShapeJoin::linear, 0, 0.5, {positions, normals});
  EXPECT_EQ(normals[0], Vec3f::UnitY());
  EXPECT_EQ(positions[0], Vec3f(0.5f, 0, 0));
}

TEST(KeyFrameMesh, EndsAndSingleKeysHold) {
  const KeyFrameMesh mesh = parabolas({1, 2});
  const Shape before = shape(mesh, ShapeJoin::hermite, 0, -5);
  const Shape after = shape(mesh, ShapeJoin::hermite, 0, 99);
  EXPECT_EQ(before.positions[5], place(5, 1));
  EXPECT_EQ(after.positions[5], place(5, 2));
  const KeyFrameMesh single = parabolas({3});
  for (const double time : {-1.0, 3.0, 4.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(shape(single, ShapeJoin::hermite, 0, time).positions[2], place(2, 3));
  }
}

TEST(KeyFrameMesh, ThreadsChangeNoBit) {
  const KeyFrameMesh mesh = parabolas({0, 0.5, 1});
  EXPECT_EQ(shape(mesh, ShapeJoin::hermite, 0.1, 0.3, 1).positions,
            shape(mesh, ShapeJoin::hermite, 0.1, 0.3, 4).positions);
}

TEST(KeyFrameMesh, WhatCannotBeIsRefused) {
  const auto code = [](const KeyFrameMesh& mesh) {
    const Status status = check(mesh);
    return status ? std::string() : status.error().code;
  };
  const KeyFrameMesh good = parabolas({0, 1});
  EXPECT_EQ(code(good), "");
  EXPECT_EQ(code({}), "key-mesh-shape");
  KeyFrameMesh bad = good;
  bad.times = {1, 1};
  EXPECT_EQ(code(bad), "key-mesh-time");
  bad.times = {1, 0};
  EXPECT_EQ(code(bad), "key-mesh-time");
  bad.times = {0, std::numeric_limits<double>::infinity()};
  EXPECT_EQ(code(bad), "key-mesh-time");
  bad = good;
  bad.positions.pop_back();
  EXPECT_EQ(code(bad), "key-mesh-shape");
  bad = good;
  bad.normals.pop_back();
  EXPECT_EQ(code(bad), "key-mesh-shape");
  bad = good;
  bad.positions[4].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code(bad), "key-mesh-value");
}

}  // namespace
}  // namespace krok
