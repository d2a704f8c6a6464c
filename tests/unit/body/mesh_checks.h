#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "body/body.h"

namespace krok::test {

// What every body must be, whatever the skeleton: one closed, oriented sphere, facing outwards,
// bound.
struct MeshFacts {
  bool closed = true;    // each edge in exactly two triangles, once in either direction
  bool manifold = true;  // the triangles around each vertex form one fan
  int pieces = 0;
  long euler = 0;
  double volume = 0;
  double turned_normals = 0;  // share of normals more than 60 degrees from their triangles' mean
  bool repeated = false;      // a triangle that names a vertex twice
};

inline MeshFacts mesh_facts(const Model& model) {
  MeshFacts facts;
  const std::size_t count = model.positions.size();
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::vector<std::uint32_t> group(count);
  std::iota(group.begin(), group.end(), 0u);
  const auto find = [&group](std::uint32_t v) {
    while (group[v] != v) v = group[v] = group[group[v]];
    return v;
  };
  std::vector<Vec3> normals(count, Vec3::Zero());
  std::vector<std::map<std::uint32_t, std::uint32_t>> fan(count);  // next around each vertex
  for (const auto& t : model.triangles) {
    facts.repeated = facts.repeated || t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    const Vec3 a = model.positions[t[0]].cast<double>(), b = model.positions[t[1]].cast<double>(),
               c = model.positions[t[2]].cast<double>();
    facts.volume += a.dot(b.cross(c)) / 6;
    const Vec3 normal = (b - a).cross(c - a);
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{t[k], t[(k + 1) % 3]}];
      group[find(t[k])] = find(t[(k + 1) % 3]);
      normals[t[k]] += normal;
      fan[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
    }
  }
  for (const auto& [edge, uses] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (uses != 1 || back == edges.end()) facts.closed = false;
  }
  for (std::uint32_t v = 0; v < count; ++v) {
    if (find(v) == v) ++facts.pieces;
    if (fan[v].empty()) {
      facts.manifold = false;
      continue;
    }
    std::size_t steps = 0;
    std::uint32_t at = fan[v].begin()->first;
    do {
      const auto next = fan[v].find(at);
      if (next == fan[v].end()) break;
      at = next->second;
      ++steps;
    } while (at != fan[v].begin()->first && steps <= fan[v].size());
    if (steps != fan[v].size()) facts.manifold = false;
    const double length = normals[v].norm();
    if (length > 0) {
      const double agreement = normals[v].dot(model.normals[v].cast<double>()) / length;
      if (agreement < 0.5) facts.turned_normals += 1.0 / static_cast<double>(count);
    }
  }
  facts.euler = static_cast<long>(count) - static_cast<long>(edges.size() / 2) +
                static_cast<long>(model.triangles.size());
  return facts;
}

inline Body build(const Skeleton& skeleton, BodyOptions options = {}) {
  auto body = make_body(skeleton, options);
  EXPECT_TRUE(body.ok()) << (body.ok() ? "" : body.error().message);
  return std::move(body).value();
}

inline void expect_valid_body(const Body& body) {
  const Model& model = body.model;
  const Status status = check(model);
  EXPECT_TRUE(status.ok()) << (status.ok() ? "" : status.error().message);
  ASSERT_GT(model.vertex_count(), 100);
  const MeshFacts facts = mesh_facts(model);
  EXPECT_TRUE(facts.closed);
  EXPECT_TRUE(facts.manifold);
  EXPECT_FALSE(facts.repeated);
  EXPECT_EQ(facts.pieces, 1);
  EXPECT_EQ(facts.euler, 2);  // a sphere: no handles
  EXPECT_GT(facts.volume, 0);
  EXPECT_NEAR(facts.volume / body.volume, 1, 1e-3);
  EXPECT_LT(facts.turned_normals, 0.001);
  ASSERT_EQ(model.normals.size(), model.positions.size());
  for (const Vec3f& normal : model.normals) ASSERT_NEAR(normal.norm(), 1, 1e-4);
  ASSERT_EQ(model.texture_coordinates.size(), model.positions.size());
  for (const Vec2f& uv : model.texture_coordinates) {
    ASSERT_TRUE((uv.array() >= 0).all() && (uv.array() <= 1).all()) << uv.transpose();
  }
  ASSERT_EQ(model.influences_per_vertex, 4);
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const float* weights = &model.influence_weights[4 * v];
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      sum += static_cast<double>(weights[k]);
      if (k > 0) {
        ASSERT_LE(weights[k], weights[k - 1]);
      }
    }
    ASSERT_NEAR(sum, 1, 1e-6);
  }
  ASSERT_EQ(model.parts.size(), 1u);
  EXPECT_EQ(model.parts[0].name, "body");
  EXPECT_EQ(model.parts[0].material, "body");
}

}  // namespace krok::test
