// If these fail, krok-import --save-character writes a character that does not hold together, loses
// a material or a byte of a texture, writes outside of its folder, or leaves half of it behind.

#include <nlohmann/json.hpp>
#include <set>

#include "core/text.h"
#include "formats/character/character_format.h"
#include "formats/material/material_format.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "imported.h"
#include "support/glb_builder.h"
#include "support/small_images.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class CharacterImportTest : public CliTest {
 protected:
  // The rig with a left eye, a morph target at half its weight, two more parts, and pictures and
  // materials under these names.
  static GlbBuilder character(const std::vector<std::string>& names) {
    GlbBuilder builder = rig();
    auto& document = builder.json;
    document["nodes"].push_back({{"name", "Eye.L"}, {"translation", {0.1, 0.2, 0.3}}});
    document["nodes"][2]["children"] = nlohmann::json::array({3});
    auto& mesh = document["meshes"][0];
    mesh["extras"] = {{"targetNames", {"Nose"}}};
    mesh["weights"] = nlohmann::json::array({0.5});
    auto& first = mesh["primitives"][0];
    first["attributes"]["TEXCOORD_0"] =
        builder.add(std::vector<float>{0, 1, 1, 1, 1, 0, 0, 0}, "VEC2");
    first["targets"] = {
        {{"POSITION",
          builder.add(std::vector<float>{0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3")}}};
    Json part = first;
    for (std::size_t m = 0; m < names.size(); ++m) {
      document["images"].push_back(
          {{"bufferView", builder.add_view(m % 2 == 0 ? png() : jpeg())}, {"name", names[m]}});
      document["textures"].push_back({{"source", m}});
      document["materials"].push_back(
          {{"name", names[m]},
           {"pbrMetallicRoughness",
            {{"baseColorTexture", {{"index", m}}}, {"roughnessFactor", 0.5}}}});
      part["material"] = m;
      if (m == 0) {
        mesh["primitives"][0] = part;
      } else {
        mesh["primitives"].push_back(part);
      }
    }
    return builder;
  }

  void put_glb(const GlbBuilder& builder) const { put("in.glb", text_of(builder.glb())); }
  ToolRun import(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), path("in.glb"));
    return run_tool("krok-import", arguments);
  }
  std::vector<std::string> names_in(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path(folder))) {
      names.push_back(entry.path().filename());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(CharacterImportTest, WritesAllThatBelongsTogether) {
  put_glb(character({"Skin", "Cloth"}));
  const ToolRun run = import({"--save-character", path("hero.character"), "-o", path("a.anim")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(listing(),
            (std::vector<std::string>{"a.anim", "hero.character", "hero.material", "hero.model",
                                      "hero_morphs.exr", "hero_textures", "in.glb"}));
  EXPECT_EQ(names_in("hero_textures"), (std::vector<std::string>{"Cloth.jpg", "Skin.png"}));
  EXPECT_EQ(get(path("hero_textures/Skin.png")), text_of(png()));
  EXPECT_EQ(get(path("hero_textures/Cloth.jpg")), text_of(jpeg()));

  const auto found = character_file::read(get(path("hero.character")));
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->name, "hero");
  EXPECT_EQ(found->model, "hero.model");
  EXPECT_EQ(found->materials, std::vector<std::string>{"hero.material"});
  ASSERT_EQ(found->parts.size(), 2u);
  EXPECT_EQ(found->parts[0].material, "Skin");
  EXPECT_EQ(found->parts[1].material, "Cloth");
  EXPECT_EQ(found->morphs, "hero_morphs.exr");
  ASSERT_EQ(found->expressions.size(), 1u);
  EXPECT_EQ(found->expressions[0].name, "Nose");
  EXPECT_EQ(found->expressions[0].weight, 0.5f);
  ASSERT_EQ(found->eyes.size(), 1u);
  EXPECT_EQ(found->eyes[0].name, "left");
  EXPECT_EQ(found->eyes[0].joint, "Eye.L");
  EXPECT_LT((found->eyes[0].position - Vec3f(0.1f, 1.2f, 0.3f)).norm(), 1e-6f);

  const auto materials = material::read(get(path("hero.material")));
  ASSERT_TRUE(materials.ok()) << materials.error().message;
  ASSERT_EQ(materials->size(), 2u);
  EXPECT_EQ((*materials)[0].base_color_texture.image->path, "hero_textures/Skin.png");
  EXPECT_EQ((*materials)[0].roughness, 0.5f);
  EXPECT_EQ((*materials)[0].metallic, 1);  // glTF's where the file has none

  const auto file = InputFile::open(path("hero.model"));
  const auto model = model::read(file->bytes());
  ASSERT_TRUE(model.ok());
  EXPECT_EQ(model->parts.at(1).material, "Cloth");
  const auto exr = InputFile::open(path("hero_morphs.exr"));
  const auto morphs = morph_exr::read(exr->bytes());
  ASSERT_TRUE(morphs.ok());
  EXPECT_EQ(morphs->vertex_count, model->vertex_count());
  EXPECT_EQ(morphs->names, std::vector<std::string>{"Nose"});
}

// Painted parts, a second set of texture coordinates and a moved texture, there and back.
TEST_F(CharacterImportTest, ColoursCoordinatesAndTransformsComeBack) {
  GlbBuilder builder = character({"Skin"});
  builder.json["nodes"].erase(3);  // the eye, which the skin does not have
  builder.json["nodes"][2].erase("children");
  auto& shape = builder.json["meshes"][0]["primitives"][0];
  shape["attributes"]["TEXCOORD_1"] =
      builder.add(std::vector<float>{0, 0.5f, 0.25f, 1, 0.75f, 0, 0, 0.125f}, "VEC2");
  shape["attributes"]["COLOR_0"] = builder.add(
      std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 51, 255, 0, 0, 255, 102, 255, 255, 255, 0},
      "VEC4", true);
  auto& material = builder.json["materials"][0];
  material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"scale", {3, 0.5}}, {"rotation", 0.3}, {"offset", {-1, 0.2}}};
  material["occlusionTexture"] = {{"index", 0}, {"texCoord", 1}};
  put_glb(builder);
  ASSERT_EQ(import({"--save-character", path("hero.character"), "-o", path("a.anim")}).exit_code,
            0);
  for (const auto& options : {std::vector<std::string>{}, {"--quantize", "--compress"}}) {
    std::vector<std::string> skin = {path("hero.character"), path("a.anim"), "-o", path("out.glb")};
    skin.insert(skin.end(), options.begin(), options.end());
    const ToolRun made = run_tool("krok-skin", skin);
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const ToolRun compared =
        run_tool("krok-diff", {path("in.glb"), path("out.glb"), "--materials", "--tolerance",
                               "0.1mm", "--angle", "0.5deg", "--match", "nearest"});
    EXPECT_EQ(compared.exit_code, 0) << compared.out << compared.err;
    EXPECT_THAT(compared.out, HasSubstr("vertex colours: "));
    EXPECT_THAT(compared.out, Not(HasSubstr("only the")));
  }
}

TEST_F(CharacterImportTest, WhatItWroteIsSound) {
  put_glb(character({"Skin"}));
  ASSERT_EQ(import({"--save-character", path("hero.character")}).exit_code, 0);
  const ToolRun info = run_tool("krok-info", {path("hero.character"), path("hero.material")});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  for (const char* text : {"a character (.character)", "Nose (0.5)", "left at 0.1, 1.2, 0.3 m",
                           "materials (.material)", "hero_textures/Skin.png (2 x 2 PNG)"}) {
    EXPECT_NE(info.out.find(text), std::string::npos) << text << "\n" << info.out;
  }
  fs::remove(path("hero_textures/Skin.png"));
  const ToolRun lost = run_tool("krok-info", {path("hero.character")});
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_TRUE(has_code(lost.err, "file-missing")) << lost.err;
}

TEST_F(CharacterImportTest, HostileNamesStayInTheFolder) {
  fs::create_directory(path("out"));
  put_glb(character({"../../evil", "..", "", "a/b", "A/B", "con\nx.png", "a.png.", "\xC5\x99",
                     std::string(300, 'x'), "-rf", ".hidden"}));
  const ToolRun run = import({"--save-character", path("out/hero.character")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(listing(), (std::vector<std::string>{"in.glb", "out"}));
  const auto names = names_in("out/hero_textures");
  EXPECT_EQ(names.size(), 11u);
  std::set<std::string> lower;
  for (const std::string& name : names) {
    EXPECT_EQ(name.find_first_of("/\\\n:*?\"<>|"), std::string::npos) << name;
    EXPECT_FALSE(name.starts_with('.') || name.starts_with('-')) << name;
    EXPECT_LE(name.size(), 120u);
    EXPECT_TRUE(name.ends_with(".png") || name.ends_with(".jpg")) << name;
    lower.insert(ascii_lower(name));
  }
  EXPECT_EQ(lower.size(), names.size());
  EXPECT_EQ(run_tool("krok-info", {path("out/hero.character")}).exit_code, 0);
}

TEST_F(CharacterImportTest, NothingIsLeftOfWhatFails) {
  put_glb(character({"Skin"}));
  put("hero.character", "mine");
  const ToolRun run = import({"--save-character", path("hero.character"), "--no-clobber"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(listing(), (std::vector<std::string>{"hero.character", "in.glb"}));
  EXPECT_EQ(get(path("hero.character")), "mine");
  // A file where the folder would be.
  put("hero_textures", "mine");
  const ToolRun taken = import({"--save-character", path("hero.character")});
  EXPECT_EQ(taken.exit_code, 2);
  EXPECT_TRUE(has_code(taken.err, "file-unwritable")) << taken.err;
  EXPECT_EQ(listing(), (std::vector<std::string>{"hero.character", "hero_textures", "in.glb"}));
  EXPECT_EQ(get(path("hero.character")), "mine");
}

TEST_F(CharacterImportTest, OptionsThatContradictItAreErrors) {
  put_glb(character({"Skin"}));
  put("in.bvh", capture(3));
  EXPECT_EQ(
      import({"--save-character", path("a.character"), "--save-model", path("a.model")}).exit_code,
      2);
  EXPECT_EQ(import({"--save-character", path("a.model")}).exit_code, 2);
  EXPECT_EQ(import({"--save-character", "-"}).exit_code, 2);
  const ToolRun capture_run =
      run_tool("krok-import", {path("in.bvh"), "--save-character", path("a.character")});
  EXPECT_EQ(capture_run.exit_code, 2);
  EXPECT_TRUE(has_code(capture_run.err, "import-missing")) << capture_run.err;
  EXPECT_EQ(listing(), (std::vector<std::string>{"in.bvh", "in.glb"}));
}

TEST_F(CharacterImportTest, AActorWithoutMaterialsHasNone) {
  put("in.glb", text_of(rig().glb()));
  const ToolRun run = import({"--save-character", path("hero.character")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(listing(), (std::vector<std::string>{"hero.character", "hero.model", "in.glb"}));
  EXPECT_EQ(run_tool("krok-info", {path("hero.character")}).exit_code, 0);
}

// Would fail if a mesh that nothing can move were taken for a character without a word.
TEST_F(CharacterImportTest, AMeshWithoutASkinIsWarnedOf) {
  put_glb(rig());
  EXPECT_FALSE(has_code(import({"--save-character", path("a.character")}).err, "import-no-skin"));
  GlbBuilder builder = rig();
  builder.json["nodes"][0].erase("skin");
  builder.json.erase("skins");
  builder.json.erase("animations");
  put_glb(builder);
  const ToolRun run = import({"--save-character", path("b.character")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has_code(run.err, "import-no-skin")) << run.err;
}

// Cameras, lights or points alone are no character: a file without a vertex would look like one.
TEST_F(CharacterImportTest, WithoutAMeshIsRefused) {
  GlbBuilder builder = rig();
  builder.json["meshes"][0]["primitives"][0]["mode"] = 0;  // points
  put_glb(builder);
  const ToolRun points = import({"--save-character", path("a.character")});
  EXPECT_EQ(points.exit_code, 2);
  EXPECT_NE(points.err.find("no mesh with triangles: --save-character"), std::string::npos)
      << points.err;
  builder = rig();
  builder.json.erase("meshes");
  builder.json["nodes"][0].erase("mesh");
  builder.json["nodes"][0].erase("skin");
  put_glb(builder);
  const ToolRun none = import({"--save-character", path("a.character")});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("no mesh: --save-character"), std::string::npos) << none.err;
  EXPECT_EQ(listing(), std::vector<std::string>{"in.glb"});
}

// A VRM's expressions would be gone without a word.
TEST_F(CharacterImportTest, ExtensionsThatAreNotReadAreNamed) {
  GlbBuilder builder = character({});
  builder.json["extensionsUsed"] = {"KHR_materials_unlit", "VRMC_vrm"};
  put_glb(builder);
  const ToolRun run = import({"--save-character", path("c.character")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has_code(run.err, "import-extension")) << run.err;
  EXPECT_NE(run.err.find("not read: extension VRMC_vrm ["), std::string::npos) << run.err;
  EXPECT_FALSE(has_code(import({"-o", path("c.anim")}).err, "import-extension"));
}

}  // namespace
}  // namespace krok::test
