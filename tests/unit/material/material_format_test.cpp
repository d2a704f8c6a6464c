// If these fail, a material looks otherwise than its file says, or a mistake in the file is passed
// over, reported at the wrong place, or fatal.

#include "formats/material/material_format.h"

#include <gtest/gtest.h>

#include "support/folder_test.h"
#include "support/small_images.h"
#include "support/told_mistakes.h"

namespace krok::material {
namespace {

constexpr const char* kGood = R"({
  "schema": "krok.material/1",
  "materials": [
    {"name": "Skin", "base_color": "#FF8000", "roughness": 0.5,
     "normal_texture": "tex/n.png", "alpha": "mask"},
    {"name": "Glass", "base_color": [0.1, 0.2, 0.3, 0.4],
     "occlusion_texture": {"file": "tex/n.png", "wrap_u": "clamp", "smooth": false,
       "set": 2, "scale": [2, -0.5], "rotation": 90, "offset": [0.25, 1e-3]},
     "comment": ["any"], "shaders": ["glass.frag"]}
  ]
})";

TEST(MaterialFile, ReadsWhatTheSpecSays) {
  const auto materials = read(kGood);
  ASSERT_TRUE(materials.ok()) << materials.error().message;
  ASSERT_EQ(materials->size(), 2u);
  const Material &skin = (*materials)[0], &glass = (*materials)[1];
  EXPECT_EQ(skin.name, "Skin");
  // The linear value of sRGB 128, as published: 0.2158605.
  EXPECT_NEAR(skin.base_color.y(), 0.2158605, 1e-6);
  EXPECT_EQ(skin.base_color.x(), 1);
  EXPECT_EQ(skin.base_color.z(), 0);
  EXPECT_EQ(skin.base_color.w(), 1);
  EXPECT_EQ(skin.roughness, 0.5f);
  EXPECT_EQ(skin.alpha, Material::Alpha::mask);
  EXPECT_EQ(skin.alpha_cutoff, 0.5f);
  EXPECT_EQ(skin.normal_texture.image->path, "tex/n.png");
  EXPECT_TRUE(skin.normal_texture.smooth);
  EXPECT_EQ(glass.base_color, Vec4f(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(glass.occlusion_texture.wrap_u, Texture::Wrap::clamp);
  EXPECT_EQ(glass.occlusion_texture.wrap_v, Texture::Wrap::repeat);
  EXPECT_FALSE(glass.occlusion_texture.smooth);
  EXPECT_EQ(glass.occlusion_texture.set, 2);
  EXPECT_EQ(glass.occlusion_texture.scale, Vec2(2, -0.5));
  EXPECT_DOUBLE_EQ(glass.occlusion_texture.rotation, kPi / 2);
  EXPECT_EQ(glass.occlusion_texture.offset, Vec2(0.25, 1e-3));
  // (1, 1) is scaled to (2, -0.5), turned to (-0.5, -2) and moved.
  EXPECT_LT((glass.occlusion_texture.at(Vec2f(1, 1)) - Vec2f(-0.25f, -1.999f)).norm(), 1e-6f);
  const std::string again = *write(*materials);
  EXPECT_EQ((*read(again))[1].occlusion_texture.offset, glass.occlusion_texture.offset);
  EXPECT_DOUBLE_EQ((*read(again))[1].occlusion_texture.rotation, kPi / 2);
  EXPECT_EQ(glass.occlusion_texture.image, skin.normal_texture.image);
  EXPECT_EQ(glass.shaders, std::vector<std::string>{"glass.frag"});
}

TEST(MaterialFile, ATextureAloneIsNotDarkened) {
  const auto materials = read(R"({"schema": "krok.material/1", "materials": [
    {"name": "a"},
    {"name": "b", "base_color_texture": "a.png", "metallic_roughness_texture": "a.png",
     "emissive_texture": "a.png"},
    {"name": "c", "base_color_texture": "a.png", "base_color": [0, 0, 0],
     "metallic_roughness_texture": "a.png", "metallic": 0, "emissive_texture": "a.png",
     "emissive": [0, 0, 0]}]})");
  ASSERT_TRUE(materials.ok()) << materials.error().message;
  const Material usual;
  EXPECT_EQ((*materials)[0].base_color, usual.base_color);
  EXPECT_EQ((*materials)[0].metallic, 0);
  EXPECT_EQ((*materials)[0].emissive, Vec3f::Zero());
  EXPECT_EQ((*materials)[1].base_color, Vec4f::Ones());
  EXPECT_EQ((*materials)[1].metallic, 1);
  EXPECT_EQ((*materials)[1].roughness, 1);
  EXPECT_EQ((*materials)[1].emissive, Vec3f::Ones());
  EXPECT_EQ((*materials)[2].base_color, Vec4f(0, 0, 0, 1));
  EXPECT_EQ((*materials)[2].metallic, 0);
  EXPECT_EQ((*materials)[2].roughness, 1);
  EXPECT_EQ((*materials)[2].emissive, Vec3f::Zero());
}

TEST(MaterialFile, FaultsAreToldWithTheirPlace) {
  const test::Mistake faults[] = {
      {"\"roughness\"", "\"roughnes\"", "material-structure 4:47", "did you mean 'roughness'?"},
      {"krok.material/1", "krok.material/2", "material-structure 2:13", "krok.material/1"},
      {"0.5", "1.5", "material-value 4:60", "expected 0 to 1"},
      {"0.5", "\"x\"", "material-value 4:60", "expected a number"},
      {"#FF8000", "#FF80", "material-value 4:36", "not a colour"},
      {"#FF8000", "#GG8000", "material-value 4:36", "not a colour"},
      {"0.4]", "1.4]", "material-value 6:37", "not a colour"},
      {"[0.1, 0.2, 0.3, 0.4]", "[0.1, 0.2]", "material-value 6:37", "not a colour"},
      {"\"mask\"", "\"maks\"", "material-value 5:46", "did you mean 'mask'?"},
      {"\"clamp\"", "\"clip\"", "material-value 7:59", "did you mean 'clamp'?"},
      {"\"Glass\"", "\"Skin\"", "material-name 6:14", "of material 0"},
      {"\"Glass\"", "\"\"", "material-value 6:14", "empty"},
      {"tex/n.png\", \"a", "../n.png\", \"a", "material-path 5:24", "leaves the folder"},
      {"tex/n.png\", \"a", "/etc/n.png\", \"a", "material-path 5:24", "not a relative path"},
      {"tex/n.png\", \"a", "c:\\\\n.png\", \"a", "material-path 5:24", "backslash"},
      {"\"tex/n.png\", \"a", "7, \"a", "material-structure 5:24", "expected an object"},
      {"\"smooth\"", "\"smoth\"", "material-structure 7:68", "did you mean 'smooth'?"},
      {"\"set\": 2", "\"set\": 8", "material-value 8:15", "whole number of 0 to 7"},
      {"[2, -0.5]", "[2]", "material-value 8:27", "list of two numbers"},
      {"90", "1e7", "material-value 8:50", "within"},
      {"[\"glass.frag\"]", "[1]", "material-value 9:38", "list of names"},
      {"\"name\": \"Skin\", ", "", "material-structure 4:5", "is missing \"name\""},
      {"]\n}", "]", "json-syntax 10:4", ""}};
  test::expect_told(kGood, faults, [](const std::string& text) { return read(text); });
}

TEST(MaterialFile, WritingRefusesWhatReadingWould) {
  Material material;
  material.name = "a";
  material.base_color_texture.image = test::image({}, "", "../a.png");
  EXPECT_EQ(write(std::vector{material}).error().code, "material-path");
  material.base_color_texture.image = test::image(test::png());  // without a path
  EXPECT_EQ(write(std::vector{material}).error().code, "material-path");
  material.base_color_texture = {};
  material.metallic = 3;
  EXPECT_EQ(write(std::vector{material}).error().code, "material-value");
  EXPECT_EQ(read(*write({}))->size(), 0u);
}

class LoadImages : public test::FolderTest {
 protected:
  Status load(std::vector<Material>& materials) {
    return load_images(materials, [&](const std::string& name) {
      ++opened_;
      return InputFile::open(path(name));
    });
  }
  int opened_ = 0;
};

TEST_F(LoadImages, EachFileIsReadOnce) {
  std::filesystem::create_directory(path("tex"));
  put("tex/n.png", test::text_of(test::png()));
  auto materials = read(kGood);
  ASSERT_TRUE(materials.ok());
  const Status status = load(*materials);
  ASSERT_TRUE(status.ok()) << status.error().message;
  EXPECT_EQ(opened_, 1);
  EXPECT_EQ((*materials)[0].normal_texture.image->bytes, test::png());
  EXPECT_EQ((*materials)[0].normal_texture.image, (*materials)[1].occlusion_texture.image);
}

TEST_F(LoadImages, TellsWhichIsMissingOrNoImage) {
  auto materials = read(kGood);
  EXPECT_EQ(load(*materials).error().code, "file-missing");
  std::filesystem::create_directory(path("tex"));
  put("tex/n.png", "GIF89a");
  const Status status = load(*materials);
  EXPECT_EQ(status.error().code, "picture-kind");
  EXPECT_EQ(status.error().where.file, path("tex/n.png"));
}

}  // namespace
}  // namespace krok::material
