// If these fail, compressed glTF files come in with other vertices, triangles or influences than
// were packed, or damaged ones crash a program, hang it or take memory out of proportion. The files
// are packed by the libraries' encoders.

#include <draco/compression/expert_encode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/gltf_reader.h"
#include "support/glb_builder.h"

namespace krok {
namespace {

using test::GlbBuilder;
using Json = nlohmann::ordered_json;

// A wavy sheet of 9 x 9 vertices with all attributes, bound to two joints.
struct Sheet {
  static constexpr std::uint32_t kSide = 9;
  std::vector<float> positions, normals, texture_coordinates, weights;
  std::vector<std::uint8_t> joints;
  std::vector<std::uint16_t> indices;

  Sheet() {
    for (std::uint32_t v = 0; v < kSide * kSide; ++v) {
      const float x = static_cast<float>(v % kSide) / (kSide - 1);
      const float y = static_cast<float>(v / kSide) / (kSide - 1);
      const Vec3f normal = Vec3f(-std::cos(x * 5), -0.3f, 2).normalized();
      positions.insert(positions.end(), {x, y, 0.2f * std::sin(x * 5) + 0.1f * y});
      normals.insert(normals.end(), {normal.x(), normal.y(), normal.z()});
      texture_coordinates.insert(texture_coordinates.end(), {x, 1 - y});
      joints.insert(joints.end(), {0, 1, 0, 0});
      weights.insert(weights.end(), {1 - x, x, 0, 0});
      if (v % kSide + 1 == kSide || v / kSide + 1 == kSide) continue;
      for (const std::uint32_t corner : {v, v + 1, v + kSide, v + kSide, v + 1, v + kSide + 1}) {
        indices.push_back(static_cast<std::uint16_t>(corner));
      }
    }
  }
  std::size_t vertices() const { return positions.size() / 3; }
};

// The sheet in a file, as it is.
GlbBuilder plain() {
  const Sheet sheet;
  GlbBuilder builder;
  Json attributes = {{"POSITION", builder.add(sheet.positions, "VEC3")},
                     {"NORMAL", builder.add(sheet.normals, "VEC3")},
                     {"TEXCOORD_0", builder.add(sheet.texture_coordinates, "VEC2")},
                     {"JOINTS_0", builder.add(sheet.joints, "VEC4")},
                     {"WEIGHTS_0", builder.add(sheet.weights, "VEC4")}};
  const int indices = builder.add(sheet.indices, "SCALAR");
  builder.json["meshes"] = {{{"primitives", {{{"attributes", attributes}, {"indices", indices}}}}}};
  builder.json["nodes"] = {
      {{"mesh", 0}, {"skin", 0}, {"children", {1, 2}}}, {{"name", "a"}}, {{"name", "b"}}};
  builder.json["skins"] = {{{"joints", {1, 2}}}};
  builder.json["scenes"] = {{{"nodes", {0}}}};
  builder.json["scene"] = 0;
  return builder;
}

template <typename T>
std::vector<std::byte> as_bytes(const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

// Packs each buffer view with EXT_meshopt_compression; what has a filter is encoded through it.
GlbBuilder meshopt_packed(bool filters) {
  GlbBuilder from = plain();
  GlbBuilder to;
  to.json = from.json;
  to.json["bufferViews"] = Json::array();
  to.json["extensionsUsed"] = to.json["extensionsRequired"] =
      nlohmann::json::array({"EXT_meshopt_compression"});
  std::size_t unpacked = 0;
  const Sheet sheet;
  for (std::size_t v = 0; v < from.json["bufferViews"].size(); ++v) {
    const Json& view = from.json["bufferViews"][v];
    std::vector<std::byte> bytes(
        from.bin.begin() + view["byteOffset"].get<long>(),
        from.bin.begin() + view["byteOffset"].get<long>() + view["byteLength"].get<long>());
    const bool indices = v == 5;
    std::string filter = "NONE";
    if (filters && v == 0) {
      filter = "EXPONENTIAL";
#if MESHOPTIMIZER_VERSION >= 190
      meshopt_encodeFilterExp(bytes.data(), sheet.vertices(), 12, 20, sheet.positions.data(),
                              meshopt_EncodeExpSharedVector);
#else
      meshopt_encodeFilterExp(bytes.data(), sheet.vertices(), 12, 20, sheet.positions.data());
#endif
    } else if (filters && v == 1) {
      filter = "OCTAHEDRAL";
      std::vector<float> four;
      for (std::size_t i = 0; i < sheet.vertices(); ++i) {
        four.insert(four.end(), &sheet.normals[3 * i], &sheet.normals[3 * i] + 3);
        four.push_back(0);
      }
      bytes.resize(sheet.vertices() * 8);
      meshopt_encodeFilterOct(bytes.data(), sheet.vertices(), 8, 16, four.data());
      to.json["accessors"][1]["componentType"] = 5122;
      to.json["accessors"][1]["normalized"] = true;
    }
    const std::size_t count = indices ? sheet.indices.size() : sheet.vertices();
    const std::size_t stride = bytes.size() / count;
    const auto* raw = reinterpret_cast<const unsigned char*>(bytes.data());
    std::vector<unsigned char> packed;
    if (indices) {
      packed.resize(meshopt_encodeIndexBufferBound(count, sheet.vertices()));
      const std::vector<unsigned int> wide(sheet.indices.begin(), sheet.indices.end());
      packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), wide.data(), count));
    } else {
      packed.resize(meshopt_encodeVertexBufferBound(count, stride));
      packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), raw, count, stride));
    }
    const std::size_t offset = (to.bin.size() + 3) / 4 * 4;
    to.bin.resize(offset);
    const auto end = as_bytes(packed);
    to.bin.insert(to.bin.end(), end.begin(), end.end());
    Json compressed = {{"buffer", 0},
                       {"byteOffset", offset},
                       {"byteLength", packed.size()},
                       {"byteStride", stride},
                       {"count", count},
                       {"mode", indices ? "TRIANGLES" : "ATTRIBUTES"},
                       {"filter", filter}};
    Json one = {{"buffer", 1},
                {"byteOffset", unpacked},
                {"byteLength", bytes.size()},
                {"extensions", {{"EXT_meshopt_compression", compressed}}}};
    if (!indices) one["byteStride"] = stride;
    to.json["bufferViews"].push_back(one);
    unpacked += bytes.size();
  }
  to.json["buffers"] = {{{"byteLength", to.bin.size()}},
                        {{"byteLength", unpacked},
                         {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  return to;
}

// Packs the primitive with KHR_draco_mesh_compression, positions to 16 bits.
GlbBuilder draco_packed() {
  const Sheet sheet;
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(sheet.vertices()));
  Json ids = Json::object();
  const auto add = [&](const char* name, draco::GeometryAttribute::Type use, auto& values,
                       draco::DataType type) {
    const std::size_t width = values.size() / sheet.vertices();
    using Number = typename std::decay_t<decltype(values)>::value_type;
    draco::GeometryAttribute attribute;
    attribute.Init(use, nullptr, static_cast<std::int8_t>(width), type, false,
                   static_cast<std::int64_t>(width * sizeof(Number)), 0);
    const int id = mesh.AddAttribute(attribute, true, mesh.num_points());
    for (std::uint32_t v = 0; v < mesh.num_points(); ++v) {
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), &values[v * width]);
    }
    mesh.attribute(id)->set_unique_id(static_cast<std::uint32_t>(7 + id));
    ids[name] = 7 + id;
    return id;
  };
  using draco::GeometryAttribute;
  const int position =
      add("POSITION", GeometryAttribute::POSITION, sheet.positions, draco::DT_FLOAT32);
  add("NORMAL", GeometryAttribute::NORMAL, sheet.normals, draco::DT_FLOAT32);
  add("TEXCOORD_0", GeometryAttribute::TEX_COORD, sheet.texture_coordinates, draco::DT_FLOAT32);
  add("JOINTS_0", GeometryAttribute::GENERIC, sheet.joints, draco::DT_UINT8);
  add("WEIGHTS_0", GeometryAttribute::GENERIC, sheet.weights, draco::DT_FLOAT32);
  for (std::size_t i = 0; i < sheet.indices.size(); i += 3) {
    mesh.AddFace({draco::PointIndex(sheet.indices[i]), draco::PointIndex(sheet.indices[i + 1]),
                  draco::PointIndex(sheet.indices[i + 2])});
  }
  draco::ExpertEncoder encoder(mesh);
  encoder.SetAttributeQuantization(position, 16);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  GlbBuilder to = plain();
  to.bin.clear();
  to.json["bufferViews"] = Json::array();
  for (Json& accessor : to.json["accessors"]) accessor.erase("bufferView");
  const int view = to.add_view(std::as_bytes(std::span(buffer.data(), buffer.size())));
  to.json["extensionsUsed"] = to.json["extensionsRequired"] =
      nlohmann::json::array({"KHR_draco_mesh_compression"});
  to.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", ids}};
  return to;
}

nodes::Primitive primitive_in(const GlbBuilder& builder) {
  const auto scene = gltf::read(builder.glb());
  EXPECT_TRUE(scene.ok()) << scene.error().message;
  return scene.ok() ? scene->meshes.at(0).primitives.at(0) : nodes::Primitive();
}

// Whether two primitives have the same triangles, whatever the order of vertices and triangles: the
// vertex of `packed` at each of `whole` is found by its texture coordinates.
void expect_same(const nodes::Primitive& packed, const nodes::Primitive& whole, float tolerance,
                 float normals) {
  ASSERT_EQ(packed.vertex_count(), whole.vertex_count());
  ASSERT_EQ(packed.triangles.size(), whole.triangles.size());
  ASSERT_EQ(packed.influences_per_vertex, 4);
  std::vector<std::uint32_t> place(whole.vertex_count());  // of each packed vertex in the other
  std::vector<int> uses(whole.vertex_count(), 0);
  for (std::size_t v = 0; v < packed.vertex_count(); ++v) {
    const Vec2f uv = (*packed.texture_coordinates)[v] * (Sheet::kSide - 1);
    const auto x = static_cast<std::uint32_t>(std::lround(uv.x()));
    const auto y = static_cast<std::uint32_t>(std::lround(Sheet::kSide - 1 - uv.y()));
    const std::uint32_t other = place[v] = y * Sheet::kSide + x;
    ASSERT_LT(other, uses.size());
    ++uses[other];
    EXPECT_LE(((*packed.positions)[v] - (*whole.positions)[other]).norm(), tolerance);
    EXPECT_LE(((*packed.normals)[v].normalized() - (*whole.normals)[other]).norm(), normals);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(packed.influence_joints[4 * v + k], whole.influence_joints[4 * other + k]);
      EXPECT_NEAR(packed.influence_weights[4 * v + k], whole.influence_weights[4 * other + k],
                  1e-6f);
    }
  }
  EXPECT_THAT(uses, testing::Each(1));
  const auto sorted = [](const nodes::Primitive& primitive, auto number) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const auto& [a, b, c] : primitive.triangles) {
      std::array<std::uint32_t, 3> one{number(a), number(b), number(c)};
      std::rotate(one.begin(), std::min_element(one.begin(), one.end()), one.end());
      triangles.push_back(one);
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
  };
  EXPECT_EQ(sorted(packed, [&](std::uint32_t v) { return place[v]; }),
            sorted(whole, [](std::uint32_t v) { return v; }));
}

TEST(GltfCompression, MeshoptWithoutFiltersIsExact) {
  expect_same(primitive_in(meshopt_packed(false)), primitive_in(plain()), 0, 1e-6f);
}

// 40 elements of 12 bytes by meshoptimizer 1.0, with each kind of channel: four bytes, two numbers
// of 16 bits, a float.
constexpr unsigned char kSecondCodec[] = {
    0xA1, 0xE5, 0x77, 0x68, 0x2A, 0x0E, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE,
    0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0x00, 0x00, 0x00, 0x00, 0x1A, 0x02, 0x23,
    0x22, 0x32, 0x23, 0x22, 0x32, 0x23, 0x22, 0x32, 0x23, 0x22, 0x32, 0x23, 0x22, 0x32, 0xBA, 0xEB,
    0x00, 0x00, 0x03, 0x03, 0x03, 0x00, 0x4A, 0xDE, 0x8D, 0x06, 0x9A, 0xD1, 0x3D, 0x56, 0xEA, 0x81,
    0x12, 0xA6, 0xC5, 0x31, 0x62, 0xF6, 0x75, 0x1E, 0xB2, 0xB9, 0x25, 0x6E, 0xFD, 0x69, 0x2A, 0xBE,
    0xAD, 0x19, 0x7A, 0xF1, 0x5D, 0x36, 0xCA, 0xA1, 0x0D, 0x86, 0xE5, 0x51, 0x42, 0x00, 0x58, 0x58,
    0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58,
    0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58,
    0x58, 0x58, 0x58, 0x58, 0x58, 0x15, 0x2A, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA,
    0x00, 0x00, 0x00, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43,
    0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43,
    0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x44, 0x43, 0x2A, 0x04, 0x44, 0x44, 0x44, 0x44,
    0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x44, 0x00,
    0x00, 0x00, 0x00, 0x05, 0x20, 0x30, 0x0F, 0x17, 0x07, 0x10, 0x00, 0x0F, 0x1A, 0x0E, 0x26, 0x2F,
    0x4C, 0x4F, 0x8F, 0xFF, 0xF8, 0xFC, 0x18, 0x30, 0xD0, 0xD0, 0x30, 0xF4, 0xC4, 0xF2, 0x62, 0xE2,
    0x62, 0xF1, 0x31, 0x18, 0xFC, 0x1E, 0xDD, 0xDD, 0x00, 0x00, 0x07, 0x03, 0x0F, 0x03, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xE8, 0x03, 0x0A, 0x00, 0x00,
    0x00, 0x40, 0xC0, 0x00, 0x01, 0x52};

TEST(GltfCompression, UnpacksTheSecondCodecOfAttributes) {
  const auto packed = std::as_bytes(std::span(kSecondCodec));
  ASSERT_TRUE(gltf::is_second_codec(packed));
  std::vector<std::byte> found(40 * 12);
  ASSERT_TRUE(gltf::unpack_second_codec(packed, 12, found));
  for (int i = 0; i < 40; ++i) {
    const std::byte* const element = found.data() + 12 * i;
    EXPECT_EQ(element[0], static_cast<std::byte>(7 * i));
    EXPECT_EQ(element[1], static_cast<std::byte>(i % 3));
    EXPECT_EQ(element[3], static_cast<std::byte>(i * i * 37));
    std::array<std::uint16_t, 2> numbers{};
    std::memcpy(numbers.data(), element + 4, 4);
    EXPECT_EQ(numbers[0], 1000 + 300 * i);
    EXPECT_EQ(numbers[1], i % 2 == 0 ? 10 : 65000);
    float value = 0;
    std::memcpy(&value, element + 8, 4);
    EXPECT_EQ(value, 0.25f * static_cast<float>(i) - 3);
  }
  for (std::size_t size = 0; size < packed.size(); ++size) {
    EXPECT_FALSE(gltf::unpack_second_codec(packed.first(size), 12, found)) << size;
  }
}

TEST(GltfCompression, UndoesTheFilterOfColours) {
  std::array<std::uint8_t, 16> colours = {64, 127, 193, 255, 102, 205, 0, 192,
                                          0,  0,   0,   255, 255, 0,   0, 160};
  gltf::unfilter_colours(std::as_writable_bytes(std::span(colours)), 4);
  EXPECT_THAT(colours, testing::ElementsAre(254, 1, 0, 255, 51, 102, 153, 128, 0, 0, 0, 255, 255,
                                            255, 255, 64));
}

// Under its later name, and with a buffer that nothing marks as one without data.
TEST(GltfCompression, MeshoptHasTwoNames) {
  GlbBuilder builder = meshopt_packed(false);
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] =
      nlohmann::json::array({"KHR_meshopt_compression"});
  for (Json& view : builder.json["bufferViews"]) {
    const Json packed = view["extensions"]["EXT_meshopt_compression"];
    view["extensions"] = {{"KHR_meshopt_compression", packed}};
  }
  builder.json["buffers"][1].erase("extensions");
  expect_same(primitive_in(builder), primitive_in(plain()), 0, 1e-6f);
}

TEST(GltfCompression, MeshoptFiltersAreUndone) {
  expect_same(primitive_in(meshopt_packed(true)), primitive_in(plain()), 2e-6f, 1e-4f);
}

TEST(GltfCompression, DracoIsUnpackedByItsIdentifiers) {
  expect_same(primitive_in(draco_packed()), primitive_in(plain()), 2e-5f, 1e-6f);
}

// Sequences of indices and keys are packed by other modes and filters than meshes.
TEST(GltfCompression, UnpacksIndexSequencesAndQuaternions) {
  GlbBuilder builder = meshopt_packed(false);
  const Sheet sheet;
  const std::vector<unsigned int> wide(sheet.indices.begin(), sheet.indices.end());
  std::vector<unsigned char> packed(
      meshopt_encodeIndexSequenceBound(wide.size(), sheet.vertices()));
  packed.resize(
      meshopt_encodeIndexSequence(packed.data(), packed.size(), wide.data(), wide.size()));
  builder.bin.resize((builder.bin.size() + 3) / 4 * 4);
  Json& view = builder.json["bufferViews"][5]["extensions"]["EXT_meshopt_compression"];
  view["mode"] = "INDICES";
  view["byteOffset"] = builder.bin.size();
  view["byteLength"] = packed.size();
  const auto end = as_bytes(packed);
  builder.bin.insert(builder.bin.end(), end.begin(), end.end());
  builder.json["buffers"][0]["byteLength"] = builder.bin.size();
  expect_same(primitive_in(builder), primitive_in(plain()), 0, 1e-6f);

  const std::vector<float> turns = {0, 0, 0, 1, 0, 0.6f, 0, 0.8f, 0.5f, -0.5f, 0.5f, 0.5f};
  std::vector<std::int16_t> encoded(turns.size());
  meshopt_encodeFilterQuat(encoded.data(), 3, 8, 14, turns.data());
  packed.resize(meshopt_encodeVertexBufferBound(3, 8));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), encoded.data(), 3, 8));
  const int times = builder.add(std::vector<float>{0, 1, 2}, "SCALAR");
  const int values = builder.add_view(std::as_bytes(std::span(packed)));
  Json& last = builder.json["bufferViews"][static_cast<std::size_t>(values)];
  last["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                   {"byteOffset", last["byteOffset"]},
                                                   {"byteLength", packed.size()},
                                                   {"byteStride", 8},
                                                   {"count", 3},
                                                   {"mode", "ATTRIBUTES"},
                                                   {"filter", "QUATERNION"}};
  const int rotations = builder.add_accessor(values, "VEC4", 5122, 3, true);
  builder.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", rotations}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
  builder.json["buffers"][0]["byteLength"] = builder.bin.size();
  const auto scene = gltf::read(builder.glb());
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  const auto& keys = *scene->animations.at(0).channels.at(0).values;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Map<const Eigen::Vector4f> key(&keys[4 * k]), wanted(&turns[4 * k]);
    EXPECT_NEAR(std::abs(key.dot(wanted)), 1, 3e-5f) << k;
  }
}

TEST(GltfCompression, RefusesWhatCannotBeUnpacked) {
  const auto code_of = [](GlbBuilder builder, auto change) {
    change(builder);
    const auto scene = gltf::read(builder.glb());
    return scene.ok() ? std::string("read") : scene.error().code;
  };
  const auto meshopt = [&](const char* member, Json value, std::size_t view = 0) {
    return code_of(meshopt_packed(false), [&](GlbBuilder& builder) {
      builder.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][member] = value;
    });
  };
  EXPECT_EQ(meshopt("mode", "WORDS"), "gltf-compression");
  EXPECT_EQ(meshopt("filter", "QUATERNION"), "gltf-compression");
  EXPECT_EQ(meshopt("filter", "OCTAHEDRAL", 5), "gltf-compression");
  EXPECT_EQ(meshopt("byteStride", 0), "gltf-compression");
  EXPECT_EQ(meshopt("byteStride", 10), "gltf-compression");
  EXPECT_EQ(meshopt("byteStride", 8, 5), "gltf-compression");
  EXPECT_EQ(meshopt("buffer", 2), "gltf-compression");
  EXPECT_EQ(meshopt("buffer", 1), "gltf-compression");  // the one without data
  EXPECT_EQ(meshopt("byteOffset", 1u << 30), "gltf-compression");
  EXPECT_EQ(meshopt("byteLength", 3), "gltf-compression");
  EXPECT_EQ(meshopt("count", 1000.5), "gltf-structure");
  EXPECT_EQ(meshopt("count", -1), "gltf-structure");
  EXPECT_EQ(meshopt("count", 100, 5), "gltf-compression");
  EXPECT_EQ(meshopt("count", std::uint64_t{1} << 62), "gltf-too-large");
  EXPECT_EQ(meshopt("count", 20), "gltf-compression");  // bytes are left over
  EXPECT_EQ(code_of(meshopt_packed(false),
                    [](GlbBuilder& b) { b.json["bufferViews"][0].erase("extensions"); }),
            "gltf-accessor");
  const auto draco = [&](const char* member, Json value) {
    return code_of(draco_packed(), [&](GlbBuilder& builder) {
      builder
          .json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"][member] =
          value;
    });
  };
  EXPECT_EQ(draco("bufferView", 4), "gltf-compression");
  EXPECT_EQ(draco("bufferView", "0"), "gltf-structure");
  EXPECT_EQ(draco("attributes", {{"POSITION", 99}}), "gltf-compression");
  EXPECT_EQ(code_of(draco_packed(),
                    [](GlbBuilder& b) {
                      b.bin.resize(40);
                      b.bin.resize(2000);
                    }),
            "gltf-compression");
}

// Any bytes may be changed: the file is refused or read, within bounds.
TEST(GltfCompression, SurvivesDamage) {
  std::mt19937 random(7);
  for (const GlbBuilder& whole : {meshopt_packed(true), draco_packed()}) {
    int refused = 0;
    for (int round = 0; round < 150; ++round) {
      GlbBuilder damaged = whole;
      for (int change = 0; change < 1 + round % 4; ++change) {
        damaged.bin[random() % damaged.bin.size()] = static_cast<std::byte>(random());
      }
      const auto scene = gltf::read(damaged.glb());
      refused += scene.ok() ? 0 : 1;
    }
    EXPECT_GT(refused, 10);
  }
}

}  // namespace
}  // namespace krok
