// If these fail, a character's materials or textures come in otherwise than its file says, or a
// file from anyone makes the reader read what it must not.

#include <gtest/gtest.h>

#include <filesystem>

#include "formats/gltf/gltf_reader.h"
#include "support/folder_test.h"
#include "support/glb_builder.h"
#include "support/small_images.h"

namespace krok {
namespace {

namespace fs = std::filesystem;

std::string base64(const std::vector<std::byte>& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned>(bytes[i + k]) : 0);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

class GltfMaterialReader : public test::FolderTest {
 protected:
  GltfMaterialReader() : builder_(test::square()) {
    builder_.json["meshes"][0]["primitives"][0]["material"] = 0;
  }

  nodes::Scene read() {
    const std::vector<std::byte> bytes = builder_.glb();
    auto scene = gltf::read(bytes, {.folder = folder_.string(), .with_materials = true});
    EXPECT_TRUE(scene.ok()) << (scene ? "" : scene.error().message);
    return scene ? *std::move(scene) : nodes::Scene();
  }
  // A material whose base colour is the only image.
  Texture read_image(const nlohmann::ordered_json& image) {
    builder_.json["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder_.json["textures"] = {{{"source", 0}}};
    builder_.json["images"] = nlohmann::json::array({image});
    scene_ = read();
    return scene_.materials.at(0).base_color_texture;
  }
  bool warned(const std::string& code) const {
    for (const Diagnostic& found : scene_.diagnostics) {
      if (found.code == code && found.severity == Severity::warning) return true;
    }
    return false;
  }

  test::GlbBuilder builder_;
  nodes::Scene scene_;
};

TEST_F(GltfMaterialReader, DefaultsAreThoseOfTheStandard) {
  builder_.json["materials"] = nlohmann::json::array({nlohmann::ordered_json::object()});
  const auto scene = read();
  ASSERT_EQ(scene.materials.size(), 1u);
  const Material& material = scene.materials[0];
  EXPECT_EQ(material.name, "material_0");
  EXPECT_EQ(material.base_color, Vec4f::Ones());
  EXPECT_EQ(material.metallic, 1);
  EXPECT_EQ(material.roughness, 1);
  EXPECT_EQ(material.emissive, Vec3f::Zero());
  EXPECT_EQ(material.alpha, Material::Alpha::opaque);
  EXPECT_EQ(scene.meshes[0].primitives[0].material_index, 0);
  EXPECT_EQ(scene.meshes[0].primitives[0].material, "");
  EXPECT_TRUE(check(scene.materials).ok());
}

TEST_F(GltfMaterialReader, WithoutBeingAskedNothingIsRead) {
  builder_.json["materials"] = {{{"name", "Skin"}}};
  const auto bytes = builder_.glb();
  const auto scene = gltf::read(bytes);
  ASSERT_TRUE(scene.ok());
  EXPECT_TRUE(scene->materials.empty());
  EXPECT_EQ(scene->meshes[0].primitives[0].material_index, -1);
  EXPECT_EQ(scene->meshes[0].primitives[0].material, "Skin");
}

TEST_F(GltfMaterialReader, NamesBecomeUnique) {
  builder_.json["materials"] = {
      {{"name", "A"}}, {{"name", "A_2"}}, {{"name", "A"}}, nlohmann::ordered_json::object()};
  const auto scene = read();
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  EXPECT_EQ(names, (std::vector<std::string>{"A", "A_2", "A_3", "material_3"}));
}

TEST_F(GltfMaterialReader, ImagesComeFromBuffersUrisAndFiles) {
  EXPECT_EQ(read_image({{"bufferView", builder_.add_view(test::png())},
                        {"mimeType", "image/png"},
                        {"name", "n"}})
                .image->bytes,
            test::png());
  EXPECT_EQ(scene_.materials[0].base_color_texture.image->name, "n");
  // The media type may lie; the bytes count.
  const Texture inside = read_image({{"uri", "data:image/png;base64," + base64(test::jpeg())}});
  ASSERT_TRUE(static_cast<bool>(inside));
  EXPECT_EQ(inside.image->bytes, test::jpeg());
  EXPECT_TRUE(scene_.files.empty());
  fs::create_directory(path("tex"));
  put("tex/a b.png", test::text_of(test::png()));
  const Texture beside = read_image({{"uri", "tex/a%20b.png"}});
  ASSERT_TRUE(static_cast<bool>(beside));
  EXPECT_EQ(beside.image->bytes, test::png());
  EXPECT_EQ(scene_.files, std::vector<std::string>{path("tex/a b.png")});
  EXPECT_TRUE(scene_.diagnostics.empty());
}

TEST_F(GltfMaterialReader, WhatLeadsOutOrIsNoImageIsLeftOutWithAWarning) {
  fs::create_directory(path("in"));
  put("secret.png", test::text_of(test::png()));
  fs::create_symlink("../secret.png", path("in/link.png"));
  put("in/text.png", "not a picture");
  folder_ = folder_ / "in";
  const std::vector<nlohmann::ordered_json> images = {
      {{"uri", "../secret.png"}},
      {{"uri", "%2e%2e/secret.png"}},
      {{"uri", "link.png"}},
      {{"uri", (folder_.parent_path() / "secret.png").string()}},
      {{"uri", "file:///etc/passwd"}},
      {{"uri", "missing.png"}},
      {{"uri", "text.png"}},
      {{"uri", ""}},
      {{"uri", 7}},
      {{"bufferView", 99}},
      {{"bufferView", -1}},
      {{"bufferView", "0"}},
      nlohmann::ordered_json::object(),
      7};
  for (const auto& image : images) {
    SCOPED_TRACE(image.dump());
    EXPECT_FALSE(static_cast<bool>(read_image(image)));
    EXPECT_TRUE(warned("gltf-picture"));
    EXPECT_EQ(scene_.materials.size(), 1u);
  }
  folder_ = folder_.parent_path();
}

TEST_F(GltfMaterialReader, ManyImagesOfTheSameBytesTakeNoMoreThanTheFile) {
  std::vector<std::byte> large = test::png();
  large.resize(100'000);  // after a PNG's end anything may follow
  const int view = builder_.add_view(large);
  for (int i = 0; i < 1000; ++i) {
    builder_.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
    builder_.json["textures"].push_back({{"source", i}});
    builder_.json["materials"].push_back({{"emissiveTexture", {{"index", i}}}});
  }
  scene_ = read();
  std::size_t bytes = 0;
  for (const Material& material : scene_.materials) {
    if (material.emissive_texture) bytes += material.emissive_texture.image->bytes.size();
  }
  EXPECT_GE(bytes, large.size());
  EXPECT_LE(bytes, builder_.bin.size());
  EXPECT_TRUE(warned("gltf-picture"));
}

TEST_F(GltfMaterialReader, OneFileIsReadOnceHoweverItIsNamed) {
  put("a.png", test::text_of(test::png()));
  builder_.json["images"] = {{{"uri", "a.png"}}, {{"uri", "./a.png"}}, {{"uri", "%61.png"}}};
  for (int i = 0; i < 3; ++i) {
    builder_.json["textures"].push_back({{"source", i}});
    builder_.json["materials"].push_back({{"emissiveTexture", {{"index", i}}}});
  }
  scene_ = read();
  EXPECT_EQ(scene_.files.size(), 1u);
  EXPECT_EQ(scene_.materials[0].emissive_texture.image, scene_.materials[2].emissive_texture.image);
}

TEST_F(GltfMaterialReader, WhatIsNotKnownIsSaid) {
  builder_.json["images"] = {{{"bufferView", builder_.add_view(test::png())}}};
  builder_.json["textures"] = {{{"source", 0}}, {{"extensions", {{"EXT_texture_webp", {}}}}}};
  builder_.json["materials"] = {{{"extensions",
                                  {{"VENDOR_look", {{"texture", 7}}},
                                   {"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}},
                                   {"KHR_materials_unlit", nlohmann::ordered_json::object()}}},
                                 {"emissiveTexture", {{"index", 0}, {"texCoord", 8}}},
                                 {"normalTexture", {{"index", 1}}},
                                 {"occlusionTexture", {{"index", 0}, {"strength", 7}}}}};
  scene_ = read();
  const Material& material = scene_.materials.at(0);
  EXPECT_TRUE(material.unlit);
  EXPECT_FALSE(static_cast<bool>(material.emissive_texture));
  EXPECT_FALSE(static_cast<bool>(material.normal_texture));
  EXPECT_EQ(material.occlusion_strength, 1);
  std::string all;
  for (const Diagnostic& found : scene_.diagnostics) all += found.message + "\n";
  EXPECT_NE(all.find("VENDOR_look"), std::string::npos) << all;
  EXPECT_EQ(all.find("KHR_materials_clearcoat"), std::string::npos) << all;
  ASSERT_EQ(material.extensions.size(), 1u);
  EXPECT_EQ(material.extensions[0].name, "KHR_materials_clearcoat");
  EXPECT_EQ(material.extensions[0].json, R"({"clearcoatFactor":1})");
  EXPECT_EQ(all.find("KHR_materials_unlit"), std::string::npos) << all;
  EXPECT_NE(all.find("1 texture with a texture coordinate set other than 0 to 7"),
            std::string::npos)
      << all;
  EXPECT_NE(all.find("1 texture without a usable image"), std::string::npos) << all;
  EXPECT_NE(all.find("1 factor of materials"), std::string::npos) << all;
}

// The set and the transform of KHR_texture_transform, which overrides the former.
TEST_F(GltfMaterialReader, TexturesKeepHowTheyUseCoordinates) {
  builder_.json["images"] = {{{"bufferView", builder_.add_view(test::png())}}};
  builder_.json["textures"] = {{{"source", 0}}};
  const nlohmann::ordered_json transform = {
      {"offset", {0.5, -2}}, {"rotation", 1.25}, {"scale", {3, 0.1}}, {"texCoord", 3}};
  builder_.json["materials"] = {
      {{"emissiveTexture", {{"index", 0}, {"texCoord", 1}}},
       {"occlusionTexture",
        {{"index", 0}, {"texCoord", 1}, {"extensions", {{"KHR_texture_transform", transform}}}}}}};
  scene_ = read();
  const Material& material = scene_.materials.at(0);
  EXPECT_TRUE(static_cast<bool>(material.emissive_texture));
  EXPECT_EQ(material.emissive_texture.set, 1);
  EXPECT_FALSE(material.emissive_texture.transforms());
  const Texture& moved = material.occlusion_texture;
  EXPECT_EQ(moved.set, 3);
  EXPECT_EQ(moved.scale, Vec2(3, 0.1));
  EXPECT_EQ(moved.rotation, 1.25);
  EXPECT_EQ(moved.offset, Vec2(0.5, -2));
  for (const Diagnostic& found : scene_.diagnostics) ADD_FAILURE() << found.message;
}

TEST_F(GltfMaterialReader, TheOlderGlossyModelIsTakenAsFarAsItGoes) {
  builder_.json["materials"] = {
      {{"extensions",
        {{"KHR_materials_pbrSpecularGlossiness",
          {{"diffuseFactor", {0.5, 0.25, 1, 1}}, {"glossinessFactor", 0.75}}}}}}};
  const auto scene = read();
  EXPECT_EQ(scene.materials.at(0).base_color, Vec4f(0.5f, 0.25f, 1, 1));
  EXPECT_EQ(scene.materials.at(0).roughness, 0.25f);
  EXPECT_EQ(scene.materials.at(0).metallic, 0);
}

TEST_F(GltfMaterialReader, NonsenseOfAnyKindIsNoTrouble) {
  const std::vector<nlohmann::ordered_json> nonsense = {
      nullptr, 7, "x", {1, 2}, -1, 1e300, {{"index", 0}}, {{"index", -5}}, {{"index", "0"}}};
  for (const char* key : {"pbrMetallicRoughness", "normalTexture", "emissiveFactor", "alphaMode",
                          "alphaCutoff", "doubleSided", "extensions", "name"}) {
    for (const auto& value : nonsense) {
      builder_.json["materials"] = {{{key, value}}};
      const auto scene = read();
      EXPECT_TRUE(check(scene.materials).ok()) << key << " " << value.dump();
    }
  }
  for (const char* list : {"materials", "textures", "images", "samplers"}) {
    for (const auto& value : nonsense) {
      builder_.json["materials"] = {{{"normalTexture", {{"index", 0}, {"scale", value}}}}};
      builder_.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
      builder_.json["images"] = {{{"uri", "a.png"}}};
      builder_.json["samplers"] = {{{"wrapS", 33071}}};
      for (const auto& one : {value, nlohmann::ordered_json::array({value})}) {
        builder_.json[list] = one;
        const auto scene = read();
        EXPECT_TRUE(check(scene.materials).ok()) << list << " " << one.dump();
      }
    }
  }
}

}  // namespace
}  // namespace krok
