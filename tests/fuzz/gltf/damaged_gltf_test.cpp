// If these fail, a damaged glTF file crashes or hangs a program, or is read as a scene that
// violates nodes/scene.h. Run with the address and undefined-behaviour sanitizers.

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "formats/gltf/gltf_reader.h"
#include "nodes/evaluate.h"
#include "support/glb_builder.h"
#include "support/small_images.h"

namespace krok {
namespace {

using Bytes = std::vector<std::byte>;

// The guarantees of nodes/scene.h on indices and sizes.
void expect_consistent(const nodes::Scene& asset) {
  const auto in = [](int index, std::size_t count) {
    return index >= 0 && static_cast<std::size_t>(index) < count;
  };
  for (const nodes::Node& node : asset.nodes) {
    ASSERT_TRUE(node.parent == -1 || in(node.parent, asset.nodes.size()));
    ASSERT_TRUE(node.mesh == -1 || in(node.mesh, asset.meshes.size()));
    ASSERT_TRUE(node.skin == -1 || in(node.skin, asset.skins.size()));
  }
  ASSERT_TRUE(check(asset.materials).ok());
  for (const Material& material : asset.materials) {
    for (const Texture* texture : textures_of(material)) {
      ASSERT_TRUE(!*texture || image_info(texture->image->bytes).ok());
    }
  }
  for (const nodes::Mesh& mesh : asset.meshes) {
    ASSERT_EQ(mesh.weights.size(), mesh.target_count());
    for (const nodes::Primitive& primitive : mesh.primitives) {
      ASSERT_TRUE(primitive.material_index == -1 ||
                  in(primitive.material_index, asset.materials.size()));
      const std::size_t vertices = primitive.vertex_count();
      ASSERT_TRUE(!primitive.normals || primitive.normals->size() == vertices);
      ASSERT_EQ(primitive.influence_weights.size(),
                vertices * static_cast<std::size_t>(primitive.influences_per_vertex));
      for (const auto& triangle : primitive.triangles) {
        for (const std::uint32_t corner : triangle) ASSERT_LT(corner, vertices);
      }
    }
  }
}

// Reads an exact-size copy, so that the sanitizer detects reads past the end; evaluates it if that
// succeeds. Returns whether it was read.
bool survive(const Bytes& bytes) {
  const std::unique_ptr<std::byte[]> copy(new std::byte[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), copy.get());
  gltf::ReadOptions options;
  options.with_materials = true;
  const auto asset = gltf::read(std::span<const std::byte>(copy.get(), bytes.size()), options);
  if (!asset) {
    EXPECT_FALSE(asset.error().code.empty());
    EXPECT_FALSE(asset.error().message.empty());
    EXPECT_LT(asset.error().message.size(), 1000u);
    return false;
  }
  expect_consistent(*asset);
  const auto evaluator = nodes::Evaluator::create(*asset);
  if (!evaluator) return true;
  nodes::Evaluation state;
  for (int animation = -1; animation < static_cast<int>(asset->animations.size()); ++animation) {
    evaluator->evaluate(animation, 0.3, state);
    if (animation < 0) continue;
    EXPECT_LT(evaluator->key_times(animation).size(), 10'000u);
  }
  return true;
}

// A square with a material that uses every texture.
test::GlbBuilder dressed() {
  test::GlbBuilder builder = test::square();
  builder.json["images"] = {{{"bufferView", builder.add_view(test::png())}},
                            {{"bufferView", builder.add_view(test::jpeg())}}};
  builder.json["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
  builder.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}}};
  const nlohmann::ordered_json first = {{"index", 0}}, second = {{"index", 1}};
  builder.json["materials"] = {
      {{"name", "Skin"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {1, 0.5, 0, 1}},
         {"baseColorTexture", first},
         {"metallicRoughnessTexture", second}}},
       {"normalTexture", second},
       {"emissiveFactor", {1, 0, 0}},
       {"emissiveTexture", first},
       {"alphaMode", "MASK"},
       {"extensions", {{"KHR_materials_unlit", nlohmann::ordered_json::object()}}}}};
  builder.json["meshes"][0]["primitives"][0]["material"] = 0;
  return builder;
}

std::vector<Bytes> files() {
  return {test::rig().glb(), test::baked_rig().glb(), dressed().glb()};
}

TEST(DamagedGltf, EveryTruncationIsAnError) {
  for (const Bytes& whole : files()) {
    ASSERT_TRUE(survive(whole));
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_FALSE(survive(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))))
          << "cut to " << size << " bytes";
    }
  }
}

TEST(DamagedGltf, EveryChangedByteIsSurvived) {
  for (const Bytes& whole : files()) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      const auto old = static_cast<unsigned>(whole[i]);
      for (const unsigned value :
           {old ^ 1u, old ^ 0x80u, 0u, 0xFFu, unsigned('9'), unsigned('{')}) {
        Bytes changed = whole;
        changed[i] = static_cast<std::byte>(value);
        survive(changed);
      }
    }
  }
}

TEST(DamagedGltf, EveryNumberOfTheJsonMayBeAnother) {
  // Replaces each run of digits by numbers that are invalid in different ways.
  for (const auto& builder : {test::rig(), test::baked_rig(), dressed()}) {
    const std::string text = builder.json.dump();
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto is_digit = [&](std::size_t k) { return text[k] >= '0' && text[k] <= '9'; };
      if (!is_digit(i) || (i > 0 && is_digit(i - 1))) continue;
      std::size_t end = i;
      while (end < text.size() && is_digit(end)) ++end;
      for (const char* number : {"-1", "0", "1", "3", "255", "65536", "2147483648", "4294967296",
                                 "18446744073709551615", "1e300", "null", "[]", "\"x\""}) {
        test::GlbBuilder changed = builder;
        const std::string other = text.substr(0, i) + number + text.substr(end);
        changed.json = nlohmann::ordered_json::parse(other, nullptr, false);
        if (!changed.json.is_discarded()) survive(changed.glb());
      }
    }
  }
}

TEST(DamagedGltf, ManyChangedBytesAtOnceAreSurvived) {
  std::mt19937 random(7);
  for (const Bytes& whole : files()) {
    for (int round = 0; round < 500; ++round) {
      Bytes changed = whole;
      for (int k = 0; k < 8; ++k) {
        changed[random() % changed.size()] = static_cast<std::byte>(random() % 256);
      }
      survive(changed);
    }
  }
}

}  // namespace
}  // namespace krok
