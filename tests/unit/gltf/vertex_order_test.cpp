// If these fail, compressed files hold equal vertices several times, or a mesh comes out of its
// reordering with other triangles, influences or morph targets.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/quantize.h"
#include "support/human_skeleton.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

// Each corner of each triangle as a vertex of its own.
Model taken_apart(const Model& model) {
  Model apart = model;
  apart.positions.clear();
  apart.normals.clear();
  apart.texture_coordinates.clear();
  apart.tangents.clear();
  apart.influence_joints.clear();
  apart.influence_weights.clear();
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  for (auto& triangle : apart.triangles) {
    for (std::uint32_t& corner : triangle) {
      const std::size_t from = corner;
      corner = static_cast<std::uint32_t>(apart.positions.size());
      apart.positions.push_back(model.positions[from]);
      if (!model.normals.empty()) apart.normals.push_back(model.normals[from]);
      if (!model.texture_coordinates.empty()) {
        apart.texture_coordinates.push_back(model.texture_coordinates[from]);
      }
      if (!model.tangents.empty()) apart.tangents.push_back(model.tangents[from]);
      for (std::size_t k = 0; k < places; ++k) {
        apart.influence_joints.push_back(model.influence_joints[from * places + k]);
        apart.influence_weights.push_back(model.influence_weights[from * places + k]);
      }
    }
  }
  return apart;
}

// What a triangle's corners are, whatever their numbers and its place: sorted.
using Corner = std::array<float, 8>;
std::vector<std::array<Corner, 3>> triangles_of(const Model& model, const MorphSet& morphs) {
  std::vector<std::array<Corner, 3>> all;
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  for (const auto& triangle : model.triangles) {
    std::array<Corner, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t v = triangle[c];
      const Vec3f &p = model.positions[v], &moved = morphs.positions[v];
      corners[c] = {p.x(),
                    p.y(),
                    p.z(),
                    moved.x(),
                    moved.y(),
                    moved.z(),
                    static_cast<float>(model.influence_joints[v * places]),
                    model.influence_weights[v * places]};
    }
    // The order round the triangle is its front; where it begins is not.
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    all.push_back(corners);
  }
  std::ranges::sort(all);
  return all;
}

MorphSet bulge(const Model& model) {
  MorphSet morphs;
  morphs.names = {"bulge"};
  morphs.vertex_count = model.vertex_count();
  for (const Vec3f& position : model.positions) morphs.positions.push_back(0.1f * position);
  return morphs;
}

TEST(OrderForCompression, WeldsEqualVerticesAndKeepsTriangles) {
  const Model whole = test::tube_model(test::human_skeleton(), 1, 12, 12);
  for (const bool quantized : {false, true}) {
    Model model = taken_apart(whole);
    MorphSet morphs = bulge(model);
    const auto before = triangles_of(model, morphs);
    std::optional<gltf::Quantization> quantization;
    if (quantized) quantization.emplace();
    gltf::order_for_compression(model, morphs, quantization);
    EXPECT_TRUE(check(model).ok());
    EXPECT_LE(model.vertex_count(), whole.vertex_count());
    EXPECT_EQ(morphs.vertex_count, model.vertex_count());
    ASSERT_EQ(morphs.positions.size(), model.positions.size());
    EXPECT_EQ(triangles_of(model, morphs), before);
  }
}

// They look alike at rest and part when the morph target moves.
TEST(OrderForCompression, KeepsApartWhatAMorphTargetParts) {
  const Model whole = test::tube_model(test::human_skeleton(), 1, 12, 12);
  Model model = taken_apart(whole);
  MorphSet morphs = bulge(model);
  for (std::size_t v = 0; v < morphs.positions.size(); ++v) {
    morphs.positions[v].x() += 0.01f * static_cast<float>(v);
  }
  const auto before = triangles_of(model, morphs);
  const int count = model.vertex_count();
  gltf::order_for_compression(model, morphs, {});
  EXPECT_EQ(model.vertex_count(), count);
  EXPECT_EQ(triangles_of(model, morphs), before);
}

}  // namespace
}  // namespace krok
