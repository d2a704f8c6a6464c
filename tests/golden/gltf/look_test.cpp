// Would fail if a glTF file with materials broke the standard, or three.js showed other colours,
// textures or eyes than the character has.

#include <nlohmann/json.hpp>

#include "formats/gltf/gltf_writer.h"
#include "golden/gltf/judges.h"
#include "support/mesh_motions.h"
#include "support/small_images.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

class GltfLook : public GltfJudges {
 protected:
  GltfLook() : model_(test::tube_model(test::turned_human())) {
    model_.texture_coordinates.assign(model_.positions.size(), Vec2f(0.25f, 0.75f));
    const auto count = static_cast<std::uint32_t>(model_.triangles.size());
    model_.parts = {{"a", "skin", 0, 10}, {"b", "glass", 10, 10}, {"c", "", 20, count - 20}};
    const auto color = test::image(test::png()), detail = test::image(test::jpeg());
    Material skin;
    skin.name = "skin";
    skin.base_color = {1, 0.5f, 0.25f, 1};
    skin.base_color_texture = {color, Texture::Wrap::clamp, Texture::Wrap::mirror, false};
    skin.metallic = 0.25f;
    skin.roughness = 0.5f;
    skin.metallic_roughness_texture = {detail};
    skin.normal_texture = {detail};
    skin.normal_scale = -0.5f;
    skin.occlusion_texture = {detail};
    skin.emissive = {0, 0, 0.5f};
    skin.emissive_texture = {color};
    skin.alpha = Material::Alpha::mask;
    skin.alpha_cutoff = 0.75f;
    Material glass;
    glass.name = "glass";
    glass.base_color.w() = 0.25f;
    glass.alpha = Material::Alpha::blend;
    glass.double_sided = true;
    glass.unlit = true;
    materials_ = {skin, glass};
    options_.materials = materials_;
    options_.eyes = eyes_;
  }

  void write(const std::string& name, const std::function<Status(OutputFile&)>& write) {
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file.ok());
    const Status status = write(*file);
    ASSERT_TRUE(status.ok()) << status.error().message;
    ASSERT_TRUE(file->commit().ok());
  }
  nlohmann::json look_at(const std::string& name) {
    judge("three_look.mjs", name);
    return nlohmann::json::parse(content("log.txt"), nullptr, false);
  }
  static std::string hexadecimal(const std::vector<std::byte>& bytes) {
    std::string text;
    for (const std::byte byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned>(byte));
    return text;
  }

  Model model_;
  std::vector<Material> materials_;
  std::vector<Character::Eye> eyes_ = {{"left", "Head", {0.03f, 1.7f, 0.1f}}};
  gltf::WriteOptions options_;
};

TEST_F(GltfLook, ShowsMaterialsTexturesAndEyes) {
  const Clip clip = test::swinging_clip(model_.skeleton, 3, 30);
  write("rig.glb", [&](OutputFile& file) { return gltf::write_rig(model_, clip, options_, file); });
  write("mesh.glb", [&](OutputFile& file) {
    return gltf::write_mesh(model_, {model_.positions, model_.normals, {}}, options_, file);
  });
  write("baked.glb", [&](OutputFile& file) {
    return gltf::write_baked(model_, test::wobble(model_, 3), options_, file);
  });
  MeshMotion with_tangents = test::wobble(model_, 3);
  with_tangents.tangents = true;
  write("whole.glb",
        [&](OutputFile& file) { return gltf::write_baked(model_, with_tangents, options_, file); });
  options_.binary = false;
  write("rig.gltf",
        [&](OutputFile& file) { return gltf::write_rig(model_, clip, options_, file); });
  model_.texture_coordinates.clear();
  write("bare.gltf",
        [&](OutputFile& file) { return gltf::write_rig(model_, clip, options_, file); });
  valid("rig.glb rig.gltf mesh.glb baked.glb whole.glb bare.gltf");

  for (const char* name : {"rig.glb", "rig.gltf", "mesh.glb", "baked.glb", "whole.glb"}) {
    SCOPED_TRACE(name);
    const auto look = look_at(name);
    ASSERT_TRUE(look.is_object()) << content("log.txt");
    ASSERT_EQ(look["meshes"].size(), 3u);
    const auto& skin = look["meshes"][0];
    EXPECT_EQ(skin["material"], "skin");
    EXPECT_EQ(skin["type"], "MeshStandardMaterial");
    EXPECT_EQ(skin["color"], nlohmann::json({1.0, 0.5, 0.25}));
    EXPECT_EQ(skin["metalness"], 0.25);
    EXPECT_EQ(skin["roughness"], 0.5);
    EXPECT_EQ(skin["emissive"], nlohmann::json({0.0, 0.0, 0.5}));
    EXPECT_EQ(skin["alphaTest"], 0.75);
    const auto png = hexadecimal(test::png()), jpeg = hexadecimal(test::jpeg());
    nlohmann::json maps = {{"map", png},        {"metalnessMap", jpeg}, {"roughnessMap", jpeg},
                           {"normalMap", jpeg}, {"aoMap", jpeg},        {"emissiveMap", png}};
    EXPECT_EQ(skin["maps"], maps);
    const auto& glass = look["meshes"][1];
    EXPECT_EQ(glass["type"], "MeshBasicMaterial");  // unlit
    EXPECT_EQ(glass["opacity"], 0.25);
    EXPECT_EQ(glass["transparent"], true);
    EXPECT_EQ(glass["doubleSided"], true);
    EXPECT_EQ(look["meshes"][2]["material"], "default");
    if (std::string_view(name).starts_with("rig")) {
      // The motion's first frame moves the eye; that it is there and near the head is enough here.
      ASSERT_TRUE(look["places"].contains("left_eye")) << look["places"];
    }
  }
}

// A painted character would come back white, a tiled texture once, ambient occlusion in the wrong
// places: in whole files and in small ones.
TEST_F(GltfLook, ShowsVertexColoursFurtherCoordinatesAndTransforms) {
  const std::size_t count = model_.positions.size();
  model_.colours.assign(count, Vec4f(0.25f, 0.5f, 1, 0.75f));
  model_.more_texture_coordinates = {std::vector<Vec2f>(count, Vec2f(0.5f, 0.125f)),
                                     std::vector<Vec2f>(count, Vec2f(0, 1))};
  Material& skin = materials_[0];
  skin.base_color_texture.scale = {4, 2};
  skin.base_color_texture.rotation = 0.5;
  skin.base_color_texture.offset = {0.25, -3};
  skin.occlusion_texture.set = 2;
  skin.emissive_texture.set = 1;
  options_.materials = materials_;
  const Clip clip = test::swinging_clip(model_.skeleton, 3, 30);
  write("rig.glb", [&](OutputFile& file) { return gltf::write_rig(model_, clip, options_, file); });
  const MeshMotion motion = test::wobble(model_, 3);
  write("baked.glb",
        [&](OutputFile& file) { return gltf::write_baked(model_, motion, options_, file); });
  options_.quantized = gltf::Quantization();
  write("small.glb",
        [&](OutputFile& file) { return gltf::write_rig(model_, clip, options_, file); });
  valid("rig.glb baked.glb small.glb");
  for (const char* name : {"rig.glb", "baked.glb", "small.glb"}) {
    SCOPED_TRACE(name);
    const auto look = look_at(name);
    ASSERT_TRUE(look.is_object()) << content("log.txt");
    const auto& mesh = look["meshes"][0];
    EXPECT_EQ(mesh["placed"]["map"], nlohmann::json({0, 4.0, 2.0, 0.5, 0.25, -3.0}));
    EXPECT_EQ(mesh["placed"]["aoMap"], nlohmann::json({2, 1.0, 1.0, 0, 0, 0}));
    EXPECT_EQ(mesh["placed"]["emissiveMap"], nlohmann::json({1, 1.0, 1.0, 0, 0, 0}));
    const nlohmann::json corners = {{"uv", {0.25, 0.75}},
                                    {"uv1", {0.5, 0.125}},
                                    {"uv2", {0, 1}},
                                    {"color", {0.25, 0.5, 1, 0.75}}};
    for (const auto& [attribute, values] : corners.items()) {
      ASSERT_EQ(mesh["corners"][attribute].size(), values.size()) << attribute;
      for (std::size_t k = 0; k < values.size(); ++k) {
        EXPECT_NEAR(mesh["corners"][attribute][k].get<double>(), values[k].get<double>(), 1e-5);
      }
    }
  }
}

}  // namespace
}  // namespace krok
