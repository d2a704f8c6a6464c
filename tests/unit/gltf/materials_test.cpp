// Would fail if a written glTF showed other materials than it was given, held pictures twice or
// otherwise than byte for byte, or held what nothing uses.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/gltf_writer.h"
#include "support/mesh_motions.h"
#include "support/small_images.h"
#include "support/test_scenes.h"
#include "unit/gltf/glb.h"

namespace krok {
namespace {

// A tube in three parts, with texture coordinates; two have the material "skin", one "cloth".
Model dressed_model() {
  Model model = test::tube_model(test::turned_human());
  model.texture_coordinates.assign(model.positions.size(), Vec2f(0.25f, 0.75f));
  const auto count = static_cast<std::uint32_t>(model.triangles.size());
  model.parts = {{"a", "skin", 0, 10}, {"b", "cloth", 10, 10}, {"c", "skin", 20, count - 20}};
  return model;
}

std::vector<Material> look() {
  const auto color = test::image(test::png(), "color");
  const auto detail = test::image(test::jpeg(), "detail");
  std::vector<Material> materials(3);
  Material& skin = materials[0];
  skin.name = "skin";
  skin.base_color = {1, 0.5f, 0.1f, 0.75f};
  skin.base_color_texture = {color};
  skin.metallic = 0.25f;
  skin.roughness = 0.5f;
  skin.metallic_roughness_texture = {detail, Texture::Wrap::clamp, Texture::Wrap::mirror};
  skin.normal_texture = {detail};
  skin.normal_scale = 2;
  skin.occlusion_texture = {detail};
  skin.occlusion_strength = 0.5f;
  skin.emissive = {0, 0.1f, 1};
  skin.emissive_texture = {color, Texture::Wrap::repeat, Texture::Wrap::repeat, false};
  skin.alpha = Material::Alpha::mask;
  skin.alpha_cutoff = 0.25f;
  skin.double_sided = true;
  materials[1].name = "never used";
  materials[1].base_color_texture = {test::image(test::png(), "never used")};
  materials[2].name = "cloth";
  materials[2].alpha = Material::Alpha::blend;
  materials[2].unlit = true;
  return materials;
}

test::Glb rig(const Model& model, const gltf::WriteOptions& options) {
  const Clip clip = test::swinging_clip(model.skeleton, 3, 30);
  return test::written(
      [&](OutputFile& file) { return gltf::write_rig(model, clip, options, file); });
}

Result<nodes::Scene> read_with_materials(const std::string& bytes) {
  gltf::ReadOptions options;
  options.with_materials = true;
  return gltf::read(std::as_bytes(std::span(bytes)), options);
}

std::string bytes_of_image(const test::Glb& glb, std::size_t image) {
  const std::size_t index = glb.json["images"].at(image).at("bufferView");
  const auto& view = glb.json["bufferViews"].at(index);
  return glb.data.substr(view["byteOffset"], view["byteLength"]);
}

TEST(GltfMaterials, HoldEveryValue) {
  const auto materials = look();
  gltf::WriteOptions options;
  options.materials = materials;
  const auto glb = rig(dressed_model(), options);
  const auto& primitives = glb.json["meshes"][0]["primitives"];
  EXPECT_EQ(primitives[0]["material"], 0);
  EXPECT_EQ(primitives[1]["material"], 1);
  EXPECT_EQ(primitives[2]["material"], 0);
  ASSERT_EQ(glb.json["materials"].size(), 2u);
  const auto& skin = glb.json["materials"][0];
  EXPECT_EQ(skin["name"], "skin");
  EXPECT_EQ(skin["pbrMetallicRoughness"]["baseColorFactor"], nlohmann::json({1.0, 0.5, 0.1, 0.75}));
  EXPECT_EQ(skin["pbrMetallicRoughness"]["metallicFactor"], 0.25);
  EXPECT_EQ(skin["pbrMetallicRoughness"]["roughnessFactor"], 0.5);
  EXPECT_EQ(skin["emissiveFactor"], nlohmann::json({0.0, 0.1, 1.0}));
  EXPECT_EQ(skin["alphaMode"], "MASK");
  EXPECT_EQ(skin["alphaCutoff"], 0.25);
  EXPECT_EQ(skin["doubleSided"], true);
  EXPECT_EQ(skin["normalTexture"]["scale"], 2.0);
  EXPECT_EQ(skin["occlusionTexture"]["strength"], 0.5);
  const auto& cloth = glb.json["materials"][1];
  EXPECT_EQ(cloth["alphaMode"], "BLEND");
  EXPECT_FALSE(cloth.contains("alphaCutoff"));
  EXPECT_TRUE(cloth["extensions"].contains("KHR_materials_unlit"));
  EXPECT_EQ(glb.json["extensionsUsed"], nlohmann::json::array({"KHR_materials_unlit"}));
  EXPECT_FALSE(glb.json.contains("extensionsRequired"));
}

TEST(GltfMaterials, ImagesStandThereOnceAndByteForByte) {
  const auto materials = look();
  gltf::WriteOptions options;
  options.materials = materials;
  const auto glb = rig(dressed_model(), options);
  ASSERT_EQ(glb.json["images"].size(), 2u);
  EXPECT_EQ(glb.json["images"][0]["mimeType"], "image/png");
  EXPECT_EQ(glb.json["images"][1]["mimeType"], "image/jpeg");
  EXPECT_EQ(bytes_of_image(glb, 0), test::text_of(test::png()));
  EXPECT_EQ(bytes_of_image(glb, 1), test::text_of(test::jpeg()));
  // Normal and occlusion are one texture; the others differ in their picture or sampler.
  EXPECT_EQ(glb.json["textures"].size(), 4u);
  EXPECT_EQ(glb.json["samplers"].size(), 2u);
  const auto& skin = glb.json["materials"][0];
  EXPECT_EQ(skin["normalTexture"]["index"], skin["occlusionTexture"]["index"]);
  const auto texture_of = [&](const nlohmann::json& info) {
    return glb.json["textures"][info["index"].get<std::size_t>()];
  };
  const auto color = texture_of(skin["pbrMetallicRoughness"]["baseColorTexture"]);
  EXPECT_EQ(color["source"], 0);
  EXPECT_FALSE(color.contains("sampler"));
  const auto surface = texture_of(skin["pbrMetallicRoughness"]["metallicRoughnessTexture"]);
  const auto& sampler = glb.json["samplers"][surface["sampler"].get<std::size_t>()];
  EXPECT_EQ(sampler["wrapS"], 33071);  // GL_CLAMP_TO_EDGE
  EXPECT_EQ(sampler["wrapT"], 33648);  // GL_MIRRORED_REPEAT
  const auto shine = texture_of(skin["emissiveTexture"]);
  EXPECT_EQ(glb.json["samplers"][shine["sampler"].get<std::size_t>()]["magFilter"], 9728);
}

TEST(GltfMaterials, WithoutTextureCoordinatesThereAreNoImages) {
  const auto materials = look();
  gltf::WriteOptions options;
  options.materials = materials;
  Model model = dressed_model();
  model.texture_coordinates.clear();
  const auto glb = rig(model, options);
  EXPECT_FALSE(glb.json.contains("images"));
  EXPECT_FALSE(glb.json.contains("textures"));
  EXPECT_FALSE(glb.json["materials"][0].contains("normalTexture"));
  EXPECT_EQ(glb.json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"], 0.25);
}

// A file that comes back must not have tangents that it had not.
TEST(GltfMaterials, TangentsAreThoseOfTheModel) {
  const auto materials = look();
  gltf::WriteOptions options;
  options.materials = materials;
  Model model = dressed_model();
  ASSERT_TRUE(model.tangents.empty());
  const auto attributes = [](const test::Glb& glb) {
    return glb.json["meshes"][0]["primitives"][0]["attributes"];
  };
  const auto baked = test::written([&](OutputFile& file) {
    return gltf::write_baked(model, test::wobble(model, 3), options, file);
  });
  for (const test::Glb& glb : {rig(model, options), baked}) {
    EXPECT_FALSE(attributes(glb).contains("TANGENT"));
    EXPECT_TRUE(glb.json["materials"][0].contains("normalTexture"));
  }
  model.tangents.assign(model.positions.size(), Vec4f(1, 0, 0, 1));
  EXPECT_TRUE(attributes(rig(model, options)).contains("TANGENT"));
}

// A model has one list of texture coordinates for all parts: those that had none are 0 in it.
TEST(GltfMaterials, CoordinatesOfPartsThatHadNoneAreLeftOut) {
  Model model = test::tube_model(test::human_skeleton());
  model.texture_coordinates.assign(model.positions.size(), Vec2f(0.5f, 0.25f));
  ASSERT_EQ(model.parts.size(), 1u);
  Model::Part bare = model.parts[0];
  bare.name = bare.mesh = "bare";
  bare.material.clear();
  bare.first_triangle = static_cast<std::uint32_t>(model.triangles.size());
  bare.triangle_count = 1;
  const auto first = static_cast<std::uint32_t>(model.positions.size());
  for (int v = 0; v < 3; ++v) {
    model.positions.push_back(model.positions[static_cast<std::size_t>(v)]);
    if (!model.normals.empty()) model.normals.push_back(model.normals[0]);
    model.texture_coordinates.emplace_back(0.0f, 0.0f);
    for (int i = 0; i < model.influences_per_vertex; ++i) {
      model.influence_joints.push_back(0);
      model.influence_weights.push_back(i == 0 ? 1.0f : 0.0f);
    }
  }
  model.triangles.push_back({first, first + 1, first + 2});
  model.parts.push_back(bare);
  const auto glb = rig(model, gltf::WriteOptions());
  ASSERT_EQ(glb.json["meshes"].size(), 2u);
  const auto attributes = [&](int mesh) {
    return glb.json["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0]["attributes"];
  };
  EXPECT_TRUE(attributes(0).contains("TEXCOORD_0"));
  EXPECT_FALSE(attributes(1).contains("TEXCOORD_0"));
}

TEST(GltfMaterials, TangentsOfBakedFramesAddUp) {
  const auto materials = look();
  gltf::WriteOptions options;
  Model model = dressed_model();
  model.tangents.assign(model.positions.size(), Vec4f(1, 0, 0, 1));
  MeshMotion motion = test::wobble(model, 3);
  motion.tangents = true;
  const auto bake = [&] {
    return test::written([&](OutputFile& file) {
      return gltf::write_baked(model, motion, options, file, nullptr, 2);
    });
  };
  // Nothing needs them.
  const auto plain = bake();
  EXPECT_FALSE(plain.json["meshes"][0]["primitives"][0]["targets"][0].contains("TANGENT"));
  options.materials = materials;
  const auto glb = bake();
  // That is told beforehand, to judge by; pictures come on top.
  EXPECT_GE(glb.data.size() - plain.data.size(),
            gltf::baked_bytes(model, 3, materials) - gltf::baked_bytes(model, 3));
  EXPECT_TRUE(glb.json["materials"][0].contains("normalTexture"));
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  const auto base = glb.values<float>(primitive["attributes"]["TANGENT"]);
  ASSERT_EQ(base.size(), 4 * model.positions.size());
  std::vector<Vec3f> positions(model.positions.size());
  std::vector<Vec4f> tangents(positions.size());
  for (int f = 1; f < 3; ++f) {
    motion.source()(f, {positions, {}, tangents});
    const auto moved = glb.values<float>(primitive["targets"][f - 1]["TANGENT"]);
    ASSERT_EQ(moved.size(), 3 * positions.size());
    for (std::size_t v = 0; v < positions.size(); ++v) {
      EXPECT_EQ(base[4 * v + 3], -1);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(base[4 * v + i] + moved[3 * v + i], tangents[v][static_cast<int>(i)], 1e-6);
      }
    }
  }
}

TEST(GltfMaterials, MeshesBakesAndTextsHaveThemToo) {
  const auto materials = look();
  const Model model = dressed_model();
  gltf::WriteOptions options;
  options.materials = materials;
  const auto mesh = test::written([&](OutputFile& file) {
    return gltf::write_mesh(model, {model.positions, model.normals, {}}, options, file);
  });
  EXPECT_EQ(bytes_of_image(mesh, 1), test::text_of(test::jpeg()));
  const auto baked = test::written([&](OutputFile& file) {
    return gltf::write_baked(model, test::wobble(model, 3), options, file);
  });
  EXPECT_EQ(bytes_of_image(baked, 0), test::text_of(test::png()));
  EXPECT_EQ(baked.json["materials"].size(), 2u);
  options.binary = false;
  Status status;
  const std::string text = test::bytes_of(
      [&](OutputFile& file) {
        return gltf::write_mesh(model, {model.positions, model.normals, {}}, options, file);
      },
      status);
  ASSERT_TRUE(status.ok()) << status.error().message;
  const auto scene = read_with_materials(text);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  ASSERT_EQ(scene->materials.size(), 2u);
  EXPECT_EQ(scene->materials[0].base_color_texture.image->bytes, test::png());
}

TEST(GltfMaterials, ComeBackAsTheyWere) {
  const auto materials = look();
  gltf::WriteOptions options;
  options.materials = materials;
  const auto glb = rig(dressed_model(), options);
  const auto scene = read_with_materials(glb.bytes);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_TRUE(scene->diagnostics.empty()) << scene->diagnostics[0].message;
  ASSERT_EQ(scene->materials.size(), 2u);
  for (const auto& [read, written] :
       {std::pair{&scene->materials[0], &materials[0]}, {&scene->materials[1], &materials[2]}}) {
    EXPECT_EQ(read->name, written->name);
    EXPECT_EQ(read->base_color, written->base_color);
    EXPECT_EQ(read->metallic, written->metallic);
    EXPECT_EQ(read->roughness, written->roughness);
    EXPECT_EQ(read->normal_scale, written->normal_scale);
    EXPECT_EQ(read->occlusion_strength, written->occlusion_strength);
    EXPECT_EQ(read->emissive, written->emissive);
    EXPECT_EQ(read->alpha, written->alpha);
    EXPECT_EQ(read->alpha_cutoff, written->alpha_cutoff);
    EXPECT_EQ(read->double_sided, written->double_sided);
    EXPECT_EQ(read->unlit, written->unlit);
    const auto textures = textures_of(*read), others = textures_of(*written);
    for (std::size_t t = 0; t < textures.size(); ++t) {
      ASSERT_EQ(static_cast<bool>(*textures[t]), static_cast<bool>(*others[t])) << t;
      if (!*others[t]) continue;
      EXPECT_EQ(textures[t]->image->bytes, others[t]->image->bytes);
      EXPECT_EQ(textures[t]->image->name, others[t]->image->name);
      EXPECT_EQ(textures[t]->wrap_u, others[t]->wrap_u);
      EXPECT_EQ(textures[t]->wrap_v, others[t]->wrap_v);
      EXPECT_EQ(textures[t]->smooth, others[t]->smooth);
    }
  }
  EXPECT_EQ(scene->meshes[0].primitives[0].material_index, 0);
  EXPECT_EQ(scene->meshes[0].primitives[1].material_index, 1);
}

// As web pages' files have them; would fail if a round trip lost them, or if a loader that knows
// nothing of them took the bytes for PNG.
TEST(GltfMaterials, WebpAndKtxComeBackWithTheirExtensions) {
  auto materials = look();
  materials[0].base_color_texture.image = test::image(test::webp());
  materials[0].normal_texture.image = test::image(test::ktx2(4, 4, 16));
  gltf::WriteOptions options;
  options.materials = materials;
  const auto glb = rig(dressed_model(), options);
  const std::vector<std::string> required = glb.json["extensionsRequired"];
  EXPECT_THAT(required, testing::UnorderedElementsAre("EXT_texture_webp", "KHR_texture_basisu"));
  std::vector<std::string> types;
  for (const nlohmann::json& texture : glb.json["textures"]) {
    if (texture.contains("source")) continue;
    const nlohmann::json& source = texture.at("extensions").items().begin().value().at("source");
    types.push_back(glb.json["images"].at(source.get<std::size_t>()).at("mimeType"));
  }
  EXPECT_THAT(types, testing::UnorderedElementsAre("image/webp", "image/ktx2"));
  const auto scene = read_with_materials(glb.bytes);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->materials[0].base_color_texture.image->bytes, test::webp());
  EXPECT_EQ(scene->materials[0].normal_texture.image->bytes, test::ktx2(4, 4, 16));
}

// A mesh without a material got a grey one when its file was written again.
TEST(GltfMaterials, PartsWithoutOneKeepNone) {
  Model model = dressed_model();
  model.parts[0].material.clear();
  gltf::WriteOptions options;
  EXPECT_TRUE(rig(model, options).json["meshes"][0]["primitives"][0].contains("material"));
  options.unnamed_is_none = true;
  EXPECT_FALSE(rig(model, options).json["meshes"][0]["primitives"][0].contains("material"));
}

TEST(GltfMaterials, FaultsAreToldBeforeAnythingIsWritten) {
  auto materials = look();
  gltf::WriteOptions options;
  options.materials = materials;
  const Model model = dressed_model();
  const auto code = [&] {
    return test::error_code([&](OutputFile& file) {
      return gltf::write_mesh(model, {model.positions, {}, {}}, options, file);
    });
  };
  materials[0].base_color_texture.image = test::image({});
  EXPECT_EQ(code(), "picture-kind");
  materials[0].base_color_texture = {};
  materials[0].roughness = 2;
  EXPECT_EQ(code(), "material-value");
}

TEST(GltfEyes, AreNodesUnderTheirJoints) {
  const Model model = dressed_model();
  const int head = model.skeleton.find("Head");
  ASSERT_GE(head, 0);
  const Vec3 place = model.skeleton.reference[head].position + Vec3(0.03, 0.05, 0.1);
  const std::vector<Character::Eye> eyes = {{"left", "Head", place.cast<float>()}};
  gltf::WriteOptions options;
  options.eyes = eyes;
  const auto glb = rig(model, options);
  const std::size_t joints = model.skeleton.names.size();
  const auto& node = glb.json["nodes"].at(joints);
  EXPECT_EQ(node["name"], "left_eye");
  const auto& children = glb.json["nodes"][static_cast<std::size_t>(head)]["children"];
  EXPECT_NE(std::find(children.begin(), children.end(), joints), children.end());
  // Placed by the joint's reference transform it is where it was said to be.
  const auto& t = node["translation"];
  const Vec3 world = model.skeleton.reference[head] * Vec3(t[0], t[1], t[2]);
  EXPECT_LT((world - place).norm(), 1e-6);
  EXPECT_EQ(glb.json["skins"][0]["joints"].size(), joints);

  // One at its joint only names that: read back, it is no joint of the skeleton.
  const std::vector<Character::Eye> at_joint = {
      {"left", "Head", model.skeleton.reference[head].position.cast<float>()}};
  for (const auto& [list, expected] : {std::pair(at_joint, joints), std::pair(eyes, joints + 1)}) {
    options.eyes = list;
    const auto back = read_with_materials(rig(model, options).bytes);
    ASSERT_TRUE(back.ok());
    const auto fixtures = std::ranges::count_if(back->nodes, &nodes::Node::fixture);
    EXPECT_EQ(fixtures, expected == joints ? 1 : 0);
  }

  const std::vector<Character::Eye> lost = {{"left", "Hat", {}}};
  options.eyes = lost;
  EXPECT_EQ(test::error_code([&](OutputFile& file) {
              return gltf::write_rig(model, test::swinging_clip(model.skeleton, 2, 30), options,
                                     file);
            }),
            "gltf-structure");
}

// A clear coat would be gone, or show the texture that has its number in the other file.
TEST(GltfMaterials, ExtensionsComeBackWithTheirTextures) {
  auto materials = look();
  Texture scaled{test::image(test::png(), "coat")};
  scaled.scale = {2, 3};
  Texture elsewhere{test::image(test::png(), "of a missing set")};
  elsewhere.set = 1;
  materials[0].extensions = {
      {"KHR_materials_clearcoat",
       R"({"clearcoatFactor":0.5,"clearcoatTexture":{"index":0,"extensions":)"
       R"({"KHR_texture_transform":{"scale":[2,3]}}},"clearcoatNormalTexture":{"index":1}})",
       {scaled, elsewhere}},
      {"KHR_materials_anisotropy", R"({"anisotropyStrength":1})"}};
  materials[2].extensions = {materials[0].extensions[1]};
  materials[0].extras = R"({"surface":["wet",1,true]})";
  gltf::WriteOptions options;
  options.materials = materials;
  Model model = dressed_model();
  model.tangents.clear();
  const auto glb = rig(model, options);
  const auto scene = read_with_materials(glb.bytes);
  ASSERT_TRUE(scene.ok());
  const Material& skin = scene->materials[0];
  ASSERT_EQ(skin.extensions.size(), 2u);
  const MaterialExtension& coat = skin.extensions[1];
  EXPECT_EQ(coat.name, "KHR_materials_clearcoat");
  EXPECT_EQ(nlohmann::json::parse(coat.json),
            nlohmann::json::parse(R"({"clearcoatFactor":0.5,"clearcoatTexture":{"index":0,)"
                                  R"("extensions":{"KHR_texture_transform":{"scale":[2,3]}}}})"));
  ASSERT_EQ(coat.textures.size(), 1u);
  EXPECT_EQ(coat.textures[0].image->name, "coat");
  EXPECT_EQ(coat.textures[0].scale, Vec2(2, 3));
  EXPECT_EQ(skin.extras, materials[0].extras);
  EXPECT_THAT(glb.json["extensionsUsed"].get<std::vector<std::string>>(),
              testing::UnorderedElementsAre("KHR_materials_anisotropy", "KHR_materials_clearcoat",
                                            "KHR_texture_transform", "KHR_materials_unlit"));
  // Without tangents it needs a normal texture.
  EXPECT_FALSE(glb.json["materials"][1]["extensions"].contains("KHR_materials_anisotropy"));
  EXPECT_TRUE(scene->diagnostics.empty());
}

// Would read before the list of materials.
TEST(GltfMaterials, ThereMayBeNone) {
  Model model = dressed_model();
  model.parts = {{"a", "", 0, static_cast<std::uint32_t>(model.triangles.size())}};
  gltf::WriteOptions options;
  options.unnamed_is_none = true;
  const auto glb = rig(model, options);
  EXPECT_FALSE(glb.json.contains("materials"));
  EXPECT_TRUE(glb.json["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_0"));
}

}  // namespace
}  // namespace krok
