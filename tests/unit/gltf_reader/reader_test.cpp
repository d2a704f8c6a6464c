// If these fail, glTF files come in with wrong vertices, triangles, influences or keys.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "formats/gltf/gltf_reader.h"
#include "support/glb_builder.h"

namespace krok {
namespace {

using test::GlbBuilder;
using testing::ElementsAre;
using Json = nlohmann::ordered_json;

nodes::Scene read_good(const GlbBuilder& builder) {
  const auto bytes = builder.glb();
  auto asset = gltf::read(bytes);
  EXPECT_TRUE(asset.ok()) << asset.error().message;
  return asset.ok() ? std::move(*asset) : nodes::Scene();
}

Json& primitive_of(GlbBuilder& builder) {
  return builder.json["meshes"][0]["primitives"][0];
}

// By which each corner of the square moves: its number along X.
std::vector<float> square_displacements() {
  return {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0};
}

// A well-known sample has the last key of a segment and the first of the next at one time: it would
// be refused.
TEST(GltfReader, OfKeysAtOneTimeTheLastIsKept) {
  GlbBuilder builder = test::rig();
  auto& animation = builder.json["animations"][0];
  const int times = builder.add(std::vector<float>{0, 0.5f, 0.5f, 0.5f, 1, 1}, "SCALAR");
  std::vector<float> places;
  for (int k = 0; k < 6; ++k) places.insert(places.end(), {static_cast<float>(k), 0, 0});
  for (const int node : {1, 2}) {
    animation["channels"].push_back({{"sampler", animation["samplers"].size()},
                                     {"target", {{"node", node}, {"path", "translation"}}}});
    animation["samplers"].push_back({{"input", times}, {"output", builder.add(places, "VEC3")}});
  }
  const nodes::Scene asset = read_good(builder);
  ASSERT_EQ(asset.animations.at(0).channels.size(), 3u);
  for (const std::size_t c : {1u, 2u}) {
    const nodes::Channel& channel = asset.animations[0].channels[c];
    EXPECT_THAT(*channel.times, ElementsAre(0, 0.5f, 1));
    EXPECT_THAT(*channel.values, ElementsAre(0, 0, 0, 3, 0, 0, 5, 0, 0));
  }
  EXPECT_EQ(asset.animations[0].channels[1].times, asset.animations[0].channels[2].times);
  ASSERT_EQ(asset.diagnostics.size(), 1u);
  EXPECT_EQ(asset.diagnostics[0].message,
            "3 keys of animations at the time of the key before: the later ones are kept");
}

TEST(GltfReader, ReadsARig) {
  const nodes::Scene asset = read_good(test::rig());
  ASSERT_EQ(asset.nodes.size(), 3u);
  EXPECT_EQ(asset.nodes[2].name, "Tip");
  EXPECT_EQ(asset.nodes[2].parent, 1);
  EXPECT_EQ(asset.nodes[0].parent, -1);
  EXPECT_TRUE(asset.nodes[2].in_scene);
  EXPECT_THAT(asset.roots, ElementsAre(0, 1));
  const nodes::Primitive& primitive = asset.meshes.at(0).primitives.at(0);
  EXPECT_EQ(primitive.vertex_count(), 4u);
  EXPECT_EQ((*primitive.positions)[2], Vec3f(1, 1, 0));
  EXPECT_EQ((*primitive.normals)[0], Vec3f(0, 0, 1));
  EXPECT_EQ(primitive.triangles.at(1), (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_EQ(primitive.influences_per_vertex, 4);
  EXPECT_EQ(primitive.influence_joints[8], 1);
  EXPECT_EQ(asset.skins.at(0).inverse_binds.at(1)(1, 3), -1.0);
  const nodes::Channel& channel = asset.animations.at(0).channels.at(0);
  EXPECT_EQ(channel.node, 2);
  EXPECT_EQ(channel.path, nodes::Path::rotation);
  EXPECT_THAT(*channel.times, ElementsAre(0.0f, 0.5f, 1.0f));
}

// Parts of one mesh that share their vertices, as this project and others write them: each gets its
// own, with its influences and targets, or a character of many parts grows out of all proportion.
TEST(GltfReader, PartsThatShareVerticesGetThoseThatTheyUse) {
  GlbBuilder builder = test::rig();
  Json& primitives = builder.json["meshes"][0]["primitives"];
  primitives[0]["targets"] = {{{"POSITION", builder.add(square_displacements(), "VEC3")}}};
  primitives[0]["indices"] = builder.add(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR");
  Json second = primitives[0];
  second["indices"] = builder.add(std::vector<std::uint16_t>{3, 0, 2}, "SCALAR");
  primitives.push_back(second);
  Json points = primitives[0];
  points["mode"] = 0;
  points["attributes"].erase("NORMAL");  // other attributes: vertices of its own
  primitives.push_back(points);
  const nodes::Scene asset = read_good(builder);
  const auto& parts = asset.meshes.at(0).primitives;
  ASSERT_EQ(parts.size(), 3U);
  const nodes::Primitive& part = parts[1];
  ASSERT_EQ(part.vertex_count(), 3U);
  EXPECT_EQ((*part.positions)[0], Vec3f(0, 0, 0));
  EXPECT_EQ((*part.positions)[1], Vec3f(1, 1, 0));
  EXPECT_EQ((*part.positions)[2], Vec3f(0, 1, 0));
  EXPECT_EQ(part.triangles.at(0), (std::array<std::uint32_t, 3>{2, 0, 1}));
  EXPECT_EQ(part.influences_per_vertex, 4);
  EXPECT_EQ(part.influence_joints[0], 0);
  EXPECT_EQ(part.influence_joints[4], 1);
  EXPECT_EQ(part.influence_weights.size(), 12U);
  EXPECT_EQ((*part.normals).size(), 3U);
  EXPECT_EQ((*part.targets.at(0).positions)[2], Vec3f(3, 0, 0));
  EXPECT_EQ(parts[0].vertex_count(), 3U);
  EXPECT_EQ(parts[2].vertex_count(), 4U);
}

TEST(GltfReader, ReadsMorphTargetsWithTheirNames) {
  const nodes::Scene asset = read_good(test::baked_rig());
  const auto& targets = asset.meshes.at(0).primitives.at(0).targets;
  ASSERT_EQ(targets.size(), 2u);
  EXPECT_EQ(targets[1].name, "full");
  EXPECT_EQ((*targets[1].positions)[2], Vec3f(-1, 1, 0));
  EXPECT_EQ(targets[1].normals, nullptr);
  EXPECT_EQ(asset.animations.at(0).channels.at(0).width, 2);
}

TEST(GltfReader, ReadsCamerasAndTheSpaceThatGltfPrescribes) {
  GlbBuilder builder = test::square();
  builder.json["cameras"] = {
      {{"name", "Lens"}, {"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}}}},
      {{"type", "perspective"}, {"perspective", {{"yfov", 9}, {"zfar", 1e300}}}},
      {{"type", "perspective"}}};
  builder.json["nodes"][0]["camera"] = 0;
  auto asset = gltf::read(builder.glb());
  ASSERT_TRUE(asset.ok()) << asset.error().message;
  ASSERT_EQ(asset->cameras.size(), 4u);
  EXPECT_EQ(asset->cameras[0].name, "Lens");
  EXPECT_EQ(asset->cameras[0].field_of_view, 0.7);
  EXPECT_EQ(asset->nodes[0].camera, 0);
  EXPECT_FALSE(asset->cameras[1].perspective);
  // Fields of view that are none become a usual one, with a warning each.
  EXPECT_NEAR(asset->cameras[2].field_of_view, kPi / 4, 1e-15);
  EXPECT_NEAR(asset->cameras[3].field_of_view, kPi / 4, 1e-15);
  ASSERT_EQ(asset->diagnostics.size(), 2u);
  EXPECT_EQ(asset->diagnostics[0].code, "gltf-camera");
  EXPECT_EQ(asset->space.metres, 1.0);
  ASSERT_TRUE(asset->space.file_to_krok);
  EXPECT_EQ(asset->space.file_to_krok->w(), 1.0);

  // A node with a camera that does not exist is no reason to refuse the meshes.
  builder.json["nodes"][0]["camera"] = 4;
  asset = gltf::read(builder.glb());
  ASSERT_TRUE(asset.ok()) << asset.error().message;
  EXPECT_EQ(asset->nodes[0].camera, -1);
  ASSERT_EQ(asset->diagnostics.size(), 3U);
  EXPECT_EQ(asset->diagnostics.back().code, "gltf-camera");
}

TEST(GltfReader, ReadsTangentsOfLengthOne) {
  GlbBuilder builder = test::square();
  auto& attributes = builder.json["meshes"][0]["primitives"][0]["attributes"];
  std::vector<float> tangents;
  for (int v = 0; v < 4; ++v) tangents.insert(tangents.end(), {0, 2, 0, v < 2 ? 1.0f : -1.0f});
  attributes["TANGENT"] = builder.add(tangents, "VEC4");
  auto asset = gltf::read(builder.glb());
  ASSERT_TRUE(asset.ok()) << asset.error().message;
  const auto& read = asset->meshes[0].primitives[0].tangents;
  ASSERT_TRUE(read);
  EXPECT_EQ((*read)[0], Vec4f(0, 1, 0, 1));
  EXPECT_EQ((*read)[3], Vec4f(0, 1, 0, -1));
  tangents[5] = 0;  // the second vertex has none
  attributes["TANGENT"] = builder.add(tangents, "VEC4");
  asset = gltf::read(builder.glb());
  ASSERT_TRUE(asset.ok());
  // It stays zero, so that who compares the others still can.
  const auto& kept = asset->meshes[0].primitives[0].tangents;
  ASSERT_TRUE(kept);
  EXPECT_EQ((*kept)[1], Vec4f(0, 0, 0, 1));
  EXPECT_EQ((*kept)[2], Vec4f(0, 1, 0, -1));
  ASSERT_EQ(asset->diagnostics.size(), 1u);
  EXPECT_EQ(asset->diagnostics[0].code, "gltf-mesh-tangents");
  EXPECT_NE(asset->diagnostics[0].message.find("1 of 4 tangents are zero, the first at vertex 1"),
            std::string::npos)
      << asset->diagnostics[0].message;
  tangents[5] = std::numeric_limits<float>::quiet_NaN();
  attributes["TANGENT"] = builder.add(tangents, "VEC4");
  asset = gltf::read(builder.glb());
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, "gltf-value");
}

TEST(GltfReader, ReadsHowMorphTargetsMoveTangents) {
  GlbBuilder builder = test::baked_rig();
  auto& primitive = builder.json["meshes"][0]["primitives"][0];
  std::vector<float> moved(12, 0.0f);
  moved[7] = 0.5f;
  primitive["targets"][1]["TANGENT"] = builder.add(moved, "VEC3");
  auto asset = gltf::read(builder.glb());
  ASSERT_TRUE(asset.ok()) << asset.error().message;
  const auto& targets = asset->meshes[0].primitives[0].targets;
  EXPECT_FALSE(targets[0].tangents);
  ASSERT_TRUE(targets[1].tangents);
  EXPECT_EQ((*targets[1].tangents)[2], Vec3f(0, 0.5f, 0));
  // One vertex short.
  moved.resize(9);
  primitive["targets"][1]["TANGENT"] = builder.add(moved, "VEC3");
  asset = gltf::read(builder.glb());
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, "gltf-mesh");
}

TEST(GltfReader, ReadsIndicesOfEachSize) {
  for (const int bytes : {1, 2, 4}) {
    GlbBuilder builder = test::square();
    const int accessor = bytes == 1   ? builder.add(std::vector<std::uint8_t>{2, 1, 0}, "SCALAR")
                         : bytes == 2 ? builder.add(std::vector<std::uint16_t>{2, 1, 0}, "SCALAR")
                                      : builder.add(std::vector<std::uint32_t>{2, 1, 0}, "SCALAR");
    primitive_of(builder)["indices"] = accessor;
    const auto triangles = read_good(builder).meshes.at(0).primitives.at(0).triangles;
    EXPECT_THAT(triangles, ElementsAre(std::array<std::uint32_t, 3>{2, 1, 0})) << bytes;
  }
}

TEST(GltfReader, WritesOutStripsFansAndPlainVertices) {
  using Triangle = std::array<std::uint32_t, 3>;
  GlbBuilder builder = test::square();
  primitive_of(builder).erase("indices");
  primitive_of(builder)["mode"] = 5;
  EXPECT_THAT(read_good(builder).meshes.at(0).primitives.at(0).triangles,
              ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
  primitive_of(builder)["mode"] = 6;
  EXPECT_THAT(read_good(builder).meshes.at(0).primitives.at(0).triangles,
              ElementsAre(Triangle{1, 2, 0}, Triangle{2, 3, 0}));
  primitive_of(builder)["mode"] = 0;
  EXPECT_TRUE(read_good(builder).meshes.at(0).primitives.at(0).triangles.empty());
}

TEST(GltfReader, ReadsInterleavedVertices) {
  GlbBuilder builder = test::square();
  std::vector<float> both;
  const auto positions = test::square_positions();
  for (std::size_t v = 0; v < 4; ++v) {
    both.insert(both.end(), positions.begin() + static_cast<std::ptrdiff_t>(3 * v),
                positions.begin() + static_cast<std::ptrdiff_t>(3 * v + 3));
    both.insert(both.end(), {1, 0, 0});
  }
  const int view = builder.add_view(std::as_bytes(std::span(both)), 24);
  const int position = builder.add_accessor(view, "VEC3", 5126, 4);
  const int normal = builder.add_accessor(view, "VEC3", 5126, 4);
  builder.json["accessors"][static_cast<std::size_t>(normal)]["byteOffset"] = 12;
  primitive_of(builder)["attributes"] = {{"POSITION", position}, {"NORMAL", normal}};
  const nodes::Scene asset = read_good(builder);
  const nodes::Primitive& primitive = asset.meshes.at(0).primitives.at(0);
  EXPECT_EQ((*primitive.positions)[3], Vec3f(0, 1, 0));
  EXPECT_EQ((*primitive.normals)[3], Vec3f(1, 0, 0));
}

TEST(GltfReader, ReadsNormalisedIntegersAndTwoSetsOfInfluences) {
  GlbBuilder builder = test::rig();
  Json& attributes = primitive_of(builder)["attributes"];
  // Bytes that sum to 255 in the first vertex, to 254 in the others.
  std::vector<std::uint8_t> first(16, 0), second(16, 0), joints(16, 0);
  for (std::size_t v = 0; v < 4; ++v) {
    first[4 * v] = 127;
    second[4 * v] = v == 0 ? 128 : 127;
    joints[4 * v] = 1;
  }
  attributes["WEIGHTS_0"] = builder.add(first, "VEC4", true);
  attributes["WEIGHTS_1"] = builder.add(second, "VEC4", true);
  attributes["JOINTS_1"] = builder.add(joints, "VEC4");
  const nodes::Scene asset = read_good(builder);
  const nodes::Primitive& primitive = asset.meshes.at(0).primitives.at(0);
  ASSERT_EQ(primitive.influences_per_vertex, 8);
  EXPECT_NEAR(primitive.influence_weights[0], 127.0 / 255.0, 1e-6);
  EXPECT_NEAR(primitive.influence_weights[4], 128.0 / 255.0, 1e-6);
  EXPECT_EQ(primitive.influence_joints[4], 1);
  EXPECT_FLOAT_EQ(primitive.influence_weights[8] + primitive.influence_weights[12], 1.0f);
}

// The first eight may be the smallest.
TEST(GltfReader, OfMoreThanEightInfluencesTheLargestAreKept) {
  GlbBuilder builder = test::rig();
  Json& attributes = primitive_of(builder)["attributes"];
  for (std::size_t set = 0; set < 3; ++set) {
    std::vector<float> weights;
    std::vector<std::uint8_t> joints;
    for (std::size_t i = 0; i < 16; ++i) {
      weights.push_back(set == 2 ? 0.2f : 0.025f);  // 8 x 0.025 + 4 x 0.2 = 1
      joints.push_back(set == 2 ? 1 : 0);
    }
    attributes["WEIGHTS_" + std::to_string(set)] = builder.add(weights, "VEC4");
    attributes["JOINTS_" + std::to_string(set)] = builder.add(joints, "VEC4");
  }
  const nodes::Scene asset = read_good(builder);
  const nodes::Primitive& primitive = asset.meshes.at(0).primitives.at(0);
  ASSERT_EQ(primitive.influences_per_vertex, 8);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_EQ(primitive.influence_joints[k], k < 4 ? 1 : 0);
    EXPECT_NEAR(primitive.influence_weights[k], (k < 4 ? 0.2 : 0.025) / 0.9, 1e-6);
  }
  ASSERT_EQ(asset.diagnostics.size(), 1u);
  EXPECT_EQ(asset.diagnostics[0].code, "gltf-mesh-influences");
  EXPECT_NE(asset.diagnostics[0].message.find("4 vertices"), std::string::npos);
  EXPECT_NE(asset.diagnostics[0].message.find("10%"), std::string::npos);
}

TEST(GltfReader, WhatIsNotReadIsSaidOnceWithItsCount) {
  GlbBuilder builder = test::rig();
  Json& attributes = primitive_of(builder)["attributes"];
  attributes["COLOR_1"] = builder.add(std::vector<float>(12, 1.0f), "VEC3");
  attributes["_HEAT"] = builder.add(std::vector<float>(8, 0.0f), "VEC2");
  attributes["WEIGHTS_0"] = builder.add(std::vector<float>(16, 0.5f), "VEC4");  // sum to 2
  const nodes::Scene asset = read_good(builder);
  ASSERT_EQ(asset.diagnostics.size(), 2u);
  EXPECT_EQ(asset.diagnostics[0].code, "gltf-mesh-weights");
  EXPECT_NE(asset.diagnostics[0].message.find("4 vertices sum to 2 to 2"), std::string::npos)
      << asset.diagnostics[0].message;
  const Diagnostic& unread = asset.diagnostics[1];
  EXPECT_EQ(unread.code, "gltf-unread");
  EXPECT_EQ(unread.severity, Severity::note);
  for (const char* what : {"COLOR_1 of 1 primitive", "_HEAT of 1 primitive"}) {
    EXPECT_NE(unread.message.find(what), std::string::npos) << unread.message;
  }
}

TEST(GltfReader, ReadsSparseValuesOverZerosAndOverAView) {
  GlbBuilder builder = test::baked_rig();
  const auto sparse = [&](int count) {
    const std::vector<std::uint8_t> index = {3};
    const std::vector<float> value = {7, 8, 9};
    const int indices = builder.add_view(std::as_bytes(std::span(index)));
    const int values = builder.add_view(std::as_bytes(std::span(value)));
    return Json{{"count", count},
                {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                {"values", {{"bufferView", values}}}};
  };
  // A target whose accessor has no view, as exporters write sparse shapes.
  Json& accessor =
      builder.json["accessors"][primitive_of(builder)["targets"][0]["POSITION"].get<std::size_t>()];
  accessor.erase("bufferView");
  accessor["sparse"] = sparse(1);
  builder.json["accessors"][primitive_of(builder)["targets"][1]["POSITION"].get<std::size_t>()]
              ["sparse"] = sparse(1);
  const nodes::Scene asset = read_good(builder);
  const auto& targets = asset.meshes.at(0).primitives.at(0).targets;
  EXPECT_EQ((*targets[0].positions)[2], Vec3f(0, 0, 0));
  EXPECT_EQ((*targets[0].positions)[3], Vec3f(7, 8, 9));
  EXPECT_EQ((*targets[1].positions)[2], Vec3f(-1, 1, 0));
  EXPECT_EQ((*targets[1].positions)[3], Vec3f(7, 8, 9));
}

TEST(GltfReader, VerticesWithoutWeightsHangOnTheirFirstJointWithAWarning) {
  GlbBuilder builder = test::rig();
  primitive_of(builder)["attributes"]["WEIGHTS_0"] =
      builder.add(std::vector<float>(16, 0.0f), "VEC4");
  const nodes::Scene asset = read_good(builder);
  EXPECT_EQ(asset.meshes.at(0).primitives.at(0).influence_weights[8], 1.0f);
  ASSERT_EQ(asset.diagnostics.size(), 1u);
  EXPECT_EQ(asset.diagnostics[0].code, "gltf-mesh-unweighted");
}

// Would fail if the reader took negative weights as 0 without a word: krok-lint could not see them.
TEST(GltfReader, NegativeWeightsAreAWarning) {
  GlbBuilder builder = test::rig();
  std::vector<float> weights(16, 0.0f);
  for (std::size_t v = 0; v < 4; ++v) weights[4 * v] = 1;
  weights[5] = -0.5f;
  primitive_of(builder)["attributes"]["WEIGHTS_0"] = builder.add(weights, "VEC4");
  const nodes::Scene asset = read_good(builder);
  ASSERT_EQ(asset.diagnostics.size(), 1u);
  EXPECT_EQ(asset.diagnostics[0].code, "gltf-mesh-weights");
  EXPECT_NE(asset.diagnostics[0].message.find("negative weights of 1 vertex"), std::string::npos);
}

TEST(GltfReader, ANodeThatIsNoRootIsShownWhereItsParentsPutIt) {
  GlbBuilder builder = test::rig();
  builder.json["scenes"][0]["nodes"] = nlohmann::json::array({2});
  const nodes::Scene asset = read_good(builder);
  EXPECT_FALSE(asset.nodes[1].in_scene);
  EXPECT_TRUE(asset.nodes[2].in_scene);
  EXPECT_THAT(asset.roots, ElementsAre(1));
  ASSERT_EQ(asset.diagnostics.size(), 1u);
  EXPECT_EQ(asset.diagnostics[0].code, "gltf-node");
}

TEST(GltfReader, WithoutScenesAllRootsAreShown) {
  GlbBuilder builder = test::rig();
  builder.json.erase("scenes");
  builder.json.erase("scene");
  const nodes::Scene asset = read_good(builder);
  EXPECT_THAT(asset.roots, ElementsAre(0, 1));
}

TEST(GltfReader, AFileWithoutAnythingIsRead) {
  const nodes::Scene asset = read_good(GlbBuilder());
  EXPECT_TRUE(asset.nodes.empty());
}

TEST(GltfReader, ChannelsOfUnknownPathsAreLeftAsideWithAWarning) {
  GlbBuilder builder = test::rig();
  builder.json["animations"][0]["channels"][0]["target"]["path"] = "pointer";
  const nodes::Scene asset = read_good(builder);
  EXPECT_TRUE(asset.animations.at(0).channels.empty());
  ASSERT_EQ(asset.diagnostics.size(), 1u);
  EXPECT_EQ(asset.diagnostics[0].code, "gltf-animation-path");
}

TEST(GltfReader, AnimationPointersToNodesAndFieldsOfViewAreRead) {
  GlbBuilder builder = test::rig();
  const int angles = builder.add(std::vector<float>{0.8f, 0.4f, 0.6f}, "SCALAR");
  auto& animation = builder.json["animations"][0];
  const int times = animation["samplers"][0]["input"];
  animation["samplers"].push_back({{"input", times}, {"output", angles}});
  const auto pointer = [](int sampler, const char* to) {
    return nlohmann::ordered_json{
        {"sampler", sampler},
        {"target",
         {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", to}}}}}}}};
  };
  animation["channels"] = {
      pointer(0, "/nodes/2/rotation"), pointer(1, "/cameras/0/perspective/yfov"),
      pointer(1, "/materials/0/emissiveFactor"), pointer(1, "/cameras/7/perspective/yfov"),
      pointer(9, "/cameras/0/perspective/yfov")};
  builder.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 1}}}}};
  builder.json["extensionsRequired"] = nlohmann::json::array({"KHR_animation_pointer"});
  const nodes::Scene asset = read_good(builder);
  ASSERT_EQ(asset.animations.at(0).channels.size(), 1u);
  EXPECT_EQ(asset.animations[0].channels[0].node, 2);
  EXPECT_EQ(asset.animations[0].channels[0].path, nodes::Path::rotation);
  ASSERT_EQ(asset.animations[0].lenses.size(), 1u);
  EXPECT_EQ(asset.animations[0].lenses[0].node, 0);
  EXPECT_THAT(*asset.animations[0].lenses[0].values, ElementsAre(0.8f, 0.4f, 0.6f));
  ASSERT_EQ(asset.diagnostics.size(), 1u);
  EXPECT_EQ(asset.diagnostics[0].code, "gltf-animation-pointer");
  EXPECT_NE(asset.diagnostics[0].message.find("3 animated properties are left out: /materials/0"),
            std::string::npos);
  // For viewers that do not know pointers: else a page of such a file is still.
  const auto plain = gltf::plain_channels(builder.glb());
  ASSERT_TRUE(plain.ok());
  const std::string text(reinterpret_cast<const char*>(plain->data()), plain->size());
  EXPECT_EQ(text.find("/nodes/2/rotation"), std::string::npos);
  const auto again = gltf::read(*plain);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(*again->animations[0].channels.at(0).values, *asset.animations[0].channels[0].values);
  EXPECT_EQ(again->animations[0].lenses.size(), 1u);
}

TEST(GltfReader, ImagesMaterialsAndExtrasDoNotMatter) {
  GlbBuilder builder = test::square();
  builder.json["images"] = {{{"bufferView", 77}}, {{"uri", "nowhere.png"}}, 5};
  builder.json["textures"] = "none";
  builder.json["materials"] = {{{"name", "Skin"}, {"extensions", 3}}};
  builder.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_mesh_quantization"};
  primitive_of(builder)["material"] = 0;
  EXPECT_EQ(read_good(builder).meshes.at(0).primitives.at(0).material, "Skin");
}

TEST(GltfReader, AByteOrderMarkBeforeTheJsonIsSkipped) {
  const std::string text = "\xEF\xBB\xBF {\"asset\": {\"version\": \"2.0\"}}";
  EXPECT_TRUE(gltf::read(std::as_bytes(std::span(text))).ok());
}

// A folder that is gone after the test.
class GltfFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("krok_gltf_files_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_ / "inner");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // The square as JSON whose buffer is at `uri`.
  Result<nodes::Scene> read_with_buffer(const std::string& uri) {
    GlbBuilder builder = test::square();
    builder.json["buffers"] = {{{"byteLength", builder.bin.size()}, {"uri", uri}}};
    std::ofstream(folder_ / "inner" / "square.gltf") << builder.json.dump(1);
    for (const char* name : {"inner/square.bin", "inner/a b.bin", "outside.bin"}) {
      std::ofstream(folder_ / name, std::ios::binary)
          .write(reinterpret_cast<const char*>(builder.bin.data()),
                 static_cast<std::streamsize>(builder.bin.size()));
    }
    return gltf::read_file((folder_ / "inner" / "square.gltf").string());
  }

  std::filesystem::path folder_;
};

TEST_F(GltfFiles, ReadsABufferBesideTheFile) {
  for (const char* uri : {"square.bin", "./square.bin", "a%20b.bin"}) {
    const auto asset = read_with_buffer(uri);
    ASSERT_TRUE(asset.ok()) << uri << ": " << asset.error().message;
    EXPECT_EQ((*asset->meshes.at(0).primitives.at(0).positions)[2], Vec3f(1, 1, 0));
  }
}

TEST_F(GltfFiles, RefusesBuffersOutsideOfTheFolder) {
  std::filesystem::create_symlink(folder_ / "outside.bin", folder_ / "inner" / "link.bin");
  std::filesystem::create_directory_symlink(folder_, folder_ / "inner" / "up");
  const std::string absolute = (folder_ / "inner" / "square.bin").string();
  for (const std::string& uri : {std::string("../outside.bin"), std::string("%2e%2e/outside.bin"),
                                 std::string("x/../../outside.bin"), absolute, "file://" + absolute,
                                 std::string("http://example.org/a.bin"), std::string("link.bin"),
                                 std::string("up/outside.bin"), std::string("..\\outside.bin"),
                                 std::string("a%00b"), std::string("bad%zz"), std::string("")}) {
    const auto asset = read_with_buffer(uri);
    ASSERT_FALSE(asset.ok()) << uri;
    EXPECT_EQ(asset.error().code, "gltf-buffer") << uri << ": " << asset.error().message;
    EXPECT_FALSE(asset.error().hint.empty());
    EXPECT_NE(asset.error().where.file, "");
  }
}

TEST_F(GltfFiles, AMissingOrShortBufferIsAnError) {
  const auto missing = read_with_buffer("missing.bin");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, "file-missing");
  ASSERT_TRUE(read_with_buffer("square.bin").ok());
  std::filesystem::resize_file(folder_ / "inner" / "square.bin", 20);
  const auto cut = gltf::read_file((folder_ / "inner" / "square.gltf").string());
  ASSERT_FALSE(cut.ok());
  EXPECT_EQ(cut.error().code, "gltf-buffer");
}

TEST_F(GltfFiles, ReadsADataUri) {
  // One vertex at (1, 2, 3) in base64.
  const std::string text = R"({"asset":{"version":"2.0"},
    "buffers":[{"byteLength":12,"uri":"data:model/unheard-of;base64,AACAPwAAAEAAAEBA"}],
    "bufferViews":[{"buffer":0,"byteLength":12}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":1,"type":"VEC3"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":0}]}]})";
  const auto asset = gltf::read(std::as_bytes(std::span(text)));
  ASSERT_TRUE(asset.ok()) << asset.error().message;
  EXPECT_EQ((*asset->meshes.at(0).primitives.at(0).positions)[0], Vec3f(1, 2, 3));
}

}  // namespace
}  // namespace krok
