#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "unit/assimp/reading.h"
#include "unit/assimp/sample_files.h"

// What the tests of all formats hold a scene against: plain forward kinematics over the numbers
// that the file was written with.

namespace krok::test {

inline const std::vector<double> kTimes = {0.0, 0.1, 0.4, 0.6};

// All joints of the rig at all frames, with what the format's axes become put before them.
inline void expect_motion(const nodes::Scene& scene, const MovingRig& rig,
                          const std::vector<double>& times, const Mat4& turn) {
  ASSERT_FALSE(scene.animations.empty());
  for (std::size_t f = 0; f < rig.frames.size(); ++f) {
    const auto world = rig.to_world(rig.frames[f]);
    for (std::size_t j = 0; j < world.size(); ++j) {
      expect_near(node_to_world(scene, rig.names[j], 0, times[f]), turn * world[j].matrix(), 1e-5,
                  fmt::format("joint {} in frame {}", rig.names[j], f));
    }
  }
}

// The rest pose leaves the mesh as it is in the file.
inline void expect_mesh(const nodes::Scene& scene, const Mat4& turn) {
  ASSERT_EQ(scene.meshes.size(), 1u);
  const auto state = evaluate(scene, -1, 0);
  ASSERT_EQ(state.positions.size(), 1u);
  ASSERT_EQ(state.positions[0].size(), 4u);
  for (const Vec3& corner : corners()) {
    const Vec3 wanted = (turn * corner.homogeneous()).head<3>();
    double nearest = 1e9;
    for (const Vec3& position : state.positions[0]) {
      nearest = std::min(nearest, (position - wanted).norm());
    }
    EXPECT_LT(nearest, 1e-5);
  }
}

// Each corner's weights, by its place in the file.
inline void expect_weights(const nodes::Scene& scene, const std::vector<std::string>& joints,
                           const Mat4& file_to_mesh = Mat4::Identity()) {
  ASSERT_EQ(scene.skins.size(), 1u);
  const nodes::Primitive& primitive = scene.meshes[0].primitives[0];
  ASSERT_GT(primitive.influences_per_vertex, 0);
  const auto each = static_cast<std::size_t>(primitive.influences_per_vertex);
  for (std::size_t c = 0; c < corners().size(); ++c) {
    const Vec3 place = (file_to_mesh * corners()[c].homogeneous()).head<3>();
    for (std::size_t v = 0; v < primitive.vertex_count(); ++v) {
      if (((*primitive.positions)[v].cast<double>() - place).norm() > 1e-5) continue;
      std::vector<double> weights(joints.size(), 0.0);
      for (std::size_t k = 0; k < each; ++k) {
        const int node = scene.skins[0].joints[primitive.influence_joints[v * each + k]];
        for (std::size_t j = 0; j < joints.size(); ++j) {
          if (scene.nodes[static_cast<std::size_t>(node)].name == joints[j]) {
            weights[j] += static_cast<double>(primitive.influence_weights[v * each + k]);
          }
        }
      }
      for (const auto& [joint, weight] : corner_weights()[c]) {
        EXPECT_NEAR(weights[static_cast<std::size_t>(joint)], weight, 1e-5) << "corner " << c;
      }
    }
  }
}

// The triangles' sides point as the file's do.
inline void expect_winding(const nodes::Scene& scene) {
  const nodes::Primitive& primitive = scene.meshes[0].primitives[0];
  ASSERT_EQ(primitive.triangles.size(), 2u);
  const auto side = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return Vec3((b - a).cross(c - a).normalized());
  };
  for (std::size_t t = 0; t < 2; ++t) {
    const auto& triangle = primitive.triangles[t];
    const auto at = [&](std::size_t k) {
      return Vec3((*primitive.positions)[triangle[k]].cast<double>());
    };
    const auto given = corner_triangles()[t];
    const auto corner = [&](std::size_t k) {
      return corners()[static_cast<std::size_t>(given[k])];
    };
    EXPECT_GT(side(at(0), at(1), at(2)).dot(side(corner(0), corner(1), corner(2))), 0.999);
  }
}

}  // namespace krok::test
