// If these fail, a damaged or malicious glTF file crashes a program, hangs it, takes memory out of
// proportion, or is read as something that it is not.

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <limits>

#include "formats/gltf/gltf_reader.h"
#include "nodes/evaluate.h"
#include "support/glb_builder.h"

namespace krok {
namespace {

using test::GlbBuilder;
using Json = nlohmann::ordered_json;

Result<nodes::Scene> read_text(std::string_view text) {
  return gltf::read(std::as_bytes(std::span(text)));
}

struct Fault {
  const char* name;
  const char* code;
  std::function<void(Json&)> make;  // on the rig's JSON
};

Json& accessor(Json& json, const char* attribute) {
  return json["accessors"]
             [json["meshes"][0]["primitives"][0]["attributes"][attribute].get<std::size_t>()];
}

const std::vector<Fault>& faults() {
  static const std::vector<Fault> list = {
      {"node_own_child", "gltf-node",
       [](Json& j) { j["nodes"][2]["children"] = nlohmann::json::array({2}); }},
      {"node_cycle", "gltf-node",
       [](Json& j) { j["nodes"][2]["children"] = nlohmann::json::array({1}); }},
      {"node_two_parents", "gltf-node",
       [](Json& j) { j["nodes"][0]["children"] = nlohmann::json::array({2}); }},
      {"node_child_missing", "gltf-node",
       [](Json& j) { j["nodes"][2]["children"] = nlohmann::json::array({9}); }},
      {"node_child_negative", "gltf-structure",
       [](Json& j) { j["nodes"][2]["children"] = nlohmann::json::array({-7}); }},
      {"node_child_wraps", "gltf-structure",
       [](Json& j) { j["nodes"][1]["children"] = nlohmann::json::array({4294967298u}); }},
      {"node_mesh_missing", "gltf-node", [](Json& j) { j["nodes"][0]["mesh"] = 1; }},
      {"node_skin_missing", "gltf-node", [](Json& j) { j["nodes"][0]["skin"] = 3; }},
      {"node_matrix_short", "gltf-node",
       [](Json& j) {
         j["nodes"][1]["matrix"] = {1, 0, 0};
       }},
      {"node_rotation_long", "gltf-node",
       [](Json& j) {
         j["nodes"][2]["rotation"] = {0, 0, 0, 1, 0};
       }},
      {"node_weights", "gltf-node",
       [](Json& j) {
         j["nodes"][0]["weights"] = {1, 2};
       }},
      {"scene_missing", "gltf-node", [](Json& j) { j["scene"] = 4; }},
      {"scene_root_missing", "gltf-node",
       [](Json& j) {
         j["scenes"][0]["nodes"] = {0, 12};
       }},
      {"mesh_without_primitives", "gltf-structure",
       [](Json& j) { j["meshes"][0]["primitives"] = Json::array(); }},
      {"mesh_primitive_number", "gltf-structure",
       [](Json& j) { j["meshes"][0]["primitives"].push_back(7); }},
      {"mesh_without_position", "gltf-mesh",
       [](Json& j) { j["meshes"][0]["primitives"][0]["attributes"].erase("POSITION"); }},
      {"mesh_mode", "gltf-mesh", [](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }},
      {"mesh_normals_too_few", "gltf-mesh", [](Json& j) { accessor(j, "NORMAL")["count"] = 3; }},
      {"mesh_joints_too_few", "gltf-mesh", [](Json& j) { accessor(j, "JOINTS_0")["count"] = 3; }},
      {"mesh_joints_alone", "gltf-mesh",
       [](Json& j) { j["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); }},
      {"mesh_index_beyond", "gltf-mesh",
       [](Json& j) {
         for (const char* name : {"POSITION", "NORMAL", "JOINTS_0", "WEIGHTS_0"}) {
           accessor(j, name)["count"] = 3;
         }
       }},
      {"mesh_weights", "gltf-mesh",
       [](Json& j) { j["meshes"][0]["weights"] = nlohmann::json::array({1}); }},
      {"accessor_missing", "gltf-accessor",
       [](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 99; }},
      {"accessor_negative", "gltf-structure",
       [](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = -5; }},
      {"accessor_type", "gltf-accessor", [](Json& j) { accessor(j, "POSITION")["type"] = "VEC2"; }},
      {"accessor_component", "gltf-accessor",
       [](Json& j) { accessor(j, "POSITION")["componentType"] = 5124; }},
      {"accessor_count_beyond", "gltf-accessor",
       [](Json& j) { accessor(j, "POSITION")["count"] = 5; }},
      {"accessor_count_huge", "gltf-accessor",
       [](Json& j) { accessor(j, "POSITION")["count"] = 4000000000u; }},
      {"accessor_count_overflow", "gltf-accessor",
       [](Json& j) { accessor(j, "POSITION")["count"] = 18446744073709551615u; }},
      {"accessor_offset_huge", "gltf-accessor",
       [](Json& j) { accessor(j, "POSITION")["byteOffset"] = 18446744073709551612u; }},
      {"accessor_view_missing", "gltf-accessor",
       [](Json& j) { accessor(j, "POSITION")["bufferView"] = 66; }},
      {"accessor_joints_float", "gltf-accessor",
       [](Json& j) { accessor(j, "JOINTS_0")["componentType"] = 5126; }},
      {"accessor_zeros_bomb", "gltf-too-large",
       [](Json& j) {
         accessor(j, "POSITION").erase("bufferView");
         accessor(j, "POSITION")["count"] = 4000000000u;
       }},
      {"sparse_index_beyond", "gltf-accessor",
       [](Json& j) {
         accessor(j, "POSITION")["sparse"] = {
             {"count", 1},
             {"indices", {{"bufferView", 1}, {"componentType", 5125}, {"byteOffset", 8}}},
             {"values", {{"bufferView", 0}}}};
       }},
      {"sparse_count", "gltf-accessor",
       [](Json& j) {
         accessor(j, "POSITION")["sparse"] = {
             {"count", -1},
             {"indices", {{"bufferView", 1}, {"componentType", 5121}}},
             {"values", {{"bufferView", 0}}}};
       }},
      {"view_beyond_buffer", "gltf-accessor",
       [](Json& j) { j["bufferViews"][0]["byteLength"] = 100000; }},
      {"view_offset_huge", "gltf-accessor",
       [](Json& j) { j["bufferViews"][0]["byteOffset"] = 18446744073709551600u; }},
      {"view_buffer_missing", "gltf-accessor", [](Json& j) { j["bufferViews"][0]["buffer"] = 5; }},
      {"view_stride_small", "gltf-accessor",
       [](Json& j) { j["bufferViews"][0]["byteStride"] = 4; }},
      {"view_stride_odd", "gltf-structure",
       [](Json& j) { j["bufferViews"][0]["byteStride"] = 13; }},
      {"buffer_too_long", "gltf-buffer",
       [](Json& j) {
         j["buffers"] = {{{"byteLength", 100000}}};
       }},
      {"buffer_length_missing", "gltf-structure",
       [](Json& j) { j["buffers"] = nlohmann::json::array({Json::object()}); }},
      {"buffer_second_without_data", "gltf-buffer",
       [](Json& j) {
         j["buffers"] = {{{"byteLength", 4}}, {{"byteLength", 4}}};
       }},
      {"buffer_not_base64", "gltf-buffer",
       [](Json& j) {
         j["buffers"] = {{{"byteLength", 4}, {"uri", "data:text/plain,abcd"}}};
       }},
      {"buffer_data_short", "gltf-buffer",
       [](Json& j) {
         j["buffers"] = {{{"byteLength", 44}, {"uri", "data:text/plain;base64,AAAA"}}};
       }},
      {"skin_joint_missing", "gltf-skin",
       [](Json& j) {
         j["skins"][0]["joints"] = {1, 77};
       }},
      {"skin_without_joints", "gltf-skin",
       [](Json& j) { j["skins"][0]["joints"] = Json::array(); }},
      {"skin_too_small", "gltf-skin",
       [](Json& j) { j["skins"][0]["joints"] = nlohmann::json::array({1}); }},
      {"skin_too_few_matrices", "gltf-skin",
       [](Json& j) {
         j["skins"][0]["joints"] = {1, 2, 0};
       }},
      {"animation_node_missing", "gltf-animation",
       [](Json& j) { j["animations"][0]["channels"][0]["target"]["node"] = 8; }},
      {"animation_sampler_missing", "gltf-animation",
       [](Json& j) { j["animations"][0]["channels"][0]["sampler"] = 8; }},
      {"animation_interpolation", "gltf-animation",
       [](Json& j) { j["animations"][0]["samplers"][0]["interpolation"] = "BEZIER"; }},
      {"animation_values_too_few", "gltf-animation",
       [](Json& j) { j["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; }},
      {"animation_weights_without_targets", "gltf-animation",
       [](Json& j) {
         j["animations"][0]["channels"][0]["target"] = {{"node", 0}, {"path", "weights"}};
       }},
      {"extension_required", "gltf-extension",
       [](Json& j) { j["extensionsRequired"] = nlohmann::json::array({"VENDOR_other_geometry"}); }},
      {"version_1", "gltf-version", [](Json& j) { j["asset"]["version"] = "1.0"; }},
      {"asset_missing", "gltf-version", [](Json& j) { j.erase("asset"); }},
      {"buffers_number", "gltf-structure", [](Json& j) { j["buffers"] = 3; }},
      {"nodes_numbers", "gltf-structure",
       [](Json& j) {
         j["nodes"] = {1, 2, 3};
       }},
  };
  return list;
}

TEST(GltfFaults, TheRigItselfIsGood) {
  ASSERT_TRUE(gltf::read(test::rig().glb()).ok());
}

class GltfFault : public testing::TestWithParam<Fault> {};

TEST_P(GltfFault, IsAnErrorWithItsCode) {
  GlbBuilder builder = test::rig();
  GetParam().make(builder.json);
  const auto asset = gltf::read(builder.glb());
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, GetParam().code) << asset.error().message;
  EXPECT_FALSE(asset.error().message.empty());
}

INSTANTIATE_TEST_SUITE_P(All, GltfFault, testing::ValuesIn(faults()),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST(GltfFaults, ValuesThatAreNotFiniteAreErrors) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    GlbBuilder builder = test::square();
    auto positions = test::square_positions();
    positions[7] = bad;
    builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
        builder.add(positions, "VEC3");
    const auto asset = gltf::read(builder.glb());
    ASSERT_FALSE(asset.ok());
    EXPECT_EQ(asset.error().code, "gltf-value");
    EXPECT_NE(asset.error().message.find("element 2"), std::string::npos) << asset.error().message;
  }
}

TEST(GltfFaults, KeyTimesMustRise) {
  GlbBuilder builder = test::rig();
  builder.json["animations"][0]["samplers"][0]["input"] =
      builder.add(std::vector<float>{0, 0.5f, 0.25f}, "SCALAR");
  const auto asset = gltf::read(builder.glb());
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, "gltf-animation");
}

TEST(GltfFaults, NumbersTooLargeForADoubleAreErrors) {
  const auto asset =
      read_text(R"({"asset":{"version":"2.0"},"nodes":[{"translation":[1e999,0,0]}]})");
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, "gltf-json");
}

TEST(GltfFaults, DeepNestingIsRefused) {
  for (const char* opening : {"[", "{\"a\":"}) {
    std::string text = R"({"asset":{"version":"2.0"},"extras":)";
    for (int i = 0; i < 1'000'000; ++i) text += opening;
    const auto asset = read_text(text);
    ASSERT_FALSE(asset.ok());
    EXPECT_EQ(asset.error().code, "gltf-json");
  }
}

TEST(GltfFaults, BracketsInStringsDoNotCountAsNesting) {
  const std::string many(500, '[');
  const auto asset = read_text(R"({"asset":{"version":"2.0","generator":"\")" + many + R"("}})");
  ASSERT_TRUE(asset.ok()) << asset.error().message;
  EXPECT_EQ(asset->generator, "\"" + many);
}

TEST(GltfFaults, BrokenJsonIsReportedWithItsPlace) {
  const auto asset = read_text("{\"asset\": {\"version\": \"2.0\"},\n \"nodes\": [}\n");
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, "gltf-json");
  EXPECT_EQ(asset.error().where.line, 2);
  EXPECT_EQ(asset.error().where.column, 12);
}

TEST(GltfFaults, OtherFilesAreNotGltf) {
  for (const char* text : {"", " ", "HIERARCHY", "glT", "glTF", "glTF\2\0\0\0", "[1]", "\"a\""}) {
    const auto asset = read_text(text);
    ASSERT_FALSE(asset.ok()) << text;
    EXPECT_EQ(asset.error().code, "gltf-container") << text;
  }
}

// Many accessors on the same bytes must not multiply them.
TEST(GltfFaults, ManyViewsOfTheSameBytesAreRefused) {
  GlbBuilder builder = test::square();
  const std::vector<float> many(300'000, 0.5f);
  const int view = builder.add_view(std::as_bytes(std::span(many)));
  Json targets = Json::array();
  builder.json["meshes"][0]["primitives"][0].erase("indices");
  builder.json["meshes"][0]["primitives"][0]["mode"] = 0;
  builder.json["meshes"][0]["primitives"][0]["attributes"] = {
      {"POSITION", builder.add_accessor(view, "VEC3", 5126, 100'000)}};
  for (int i = 0; i < 5'000; ++i) {
    targets.push_back({{"POSITION", builder.add_accessor(view, "VEC3", 5126, 100'000)}});
  }
  builder.json["meshes"][0]["primitives"][0]["targets"] = targets;
  const auto asset = gltf::read(builder.glb());
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, "gltf-too-large");
}

// One accessor that many refer to is held once.
TEST(GltfFaults, OneAccessorOfManyTargetsIsFine) {
  GlbBuilder builder = test::square();
  Json& primitive = builder.json["meshes"][0]["primitives"][0];
  for (int i = 0; i < 1'000; ++i) {
    primitive["targets"].push_back({{"POSITION", primitive["attributes"]["POSITION"]}});
  }
  const auto asset = gltf::read(builder.glb());
  ASSERT_TRUE(asset.ok()) << asset.error().message;
  EXPECT_EQ(asset->meshes[0].primitives[0].targets[999].positions,
            asset->meshes[0].primitives[0].positions);
}

TEST(GltfFaults, TooManyCopiesOfAMeshAreRefused) {
  GlbBuilder builder = test::square();
  const std::vector<float> many(90'000, 0.5f);
  builder.json["meshes"][0]["primitives"][0].erase("indices");
  builder.json["meshes"][0]["primitives"][0]["attributes"] = {
      {"POSITION", builder.add(many, "VEC3")}};
  for (int i = 0; i < 1'000; ++i) {
    builder.json["nodes"].push_back({{"mesh", 0}});
    builder.json["scenes"][0]["nodes"].push_back(i + 1);
  }
  const auto asset = gltf::read(builder.glb());
  ASSERT_TRUE(asset.ok()) << asset.error().message;
  const auto evaluator = nodes::Evaluator::create(*asset);
  ASSERT_FALSE(evaluator.ok());
  EXPECT_EQ(evaluator.error().code, "scene-too-large");
}

TEST(GltfFaults, AContainerWhoseChunkReachesBeyondTheFileIsRefused) {
  auto bytes = test::square().glb();
  // The BIN chunk's length, just beyond: tinygltf itself forgets the chunk's own header here.
  std::uint32_t json_length = 0;
  std::memcpy(&json_length, bytes.data() + 12, 4);
  std::uint32_t bin_length = 0;
  std::memcpy(&bin_length, bytes.data() + 20 + json_length, 4);
  bin_length += 4;
  std::memcpy(bytes.data() + 20 + json_length, &bin_length, 4);
  const auto asset = gltf::read(bytes);
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, "gltf-container");
}

}  // namespace
}  // namespace krok
