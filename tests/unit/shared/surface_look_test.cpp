// If these fail, pictures of figures show materials in another colour, without their texture, or
// with holes where there are none.

#include <gtest/gtest.h>

#include "skin/scene_of.h"
#include "support/small_images.h"
#include "tools/shared/drawn_scene.h"

namespace krok::cli {
namespace {

// A material with a picture and the picture decoded, one grey pixel.
struct Painted {
  Material material;
  DecodedImages images;
  SharedCoordinates coordinates =
      std::make_shared<const std::vector<Vec2f>>(std::vector<Vec2f>{{0, 0}, {1, 0}, {0, 1}});

  Painted() {
    material.name = "Skin";
    material.base_color = {1, 0.5F, 0, 0.4F};
    material.base_color_texture.image = test::image(test::png());
    images[material.base_color_texture.image.get()] =
        std::make_shared<const render::Mipmap>(*render::Mipmap::create(1, 1, {128, 128, 128, 255}));
  }
  std::optional<SurfaceLook> look() const { return look_of(material, coordinates, images); }
};

TEST(SurfaceLook, HasTheTextureAsTheMaterialSays) {
  Painted painted;
  painted.material.base_color_texture.wrap_u = Texture::Wrap::mirror;
  painted.material.base_color_texture.wrap_v = Texture::Wrap::clamp;
  painted.material.base_color_texture.smooth = false;
  const auto look = painted.look();
  ASSERT_TRUE(look && look->paint);
  EXPECT_EQ(look->paint->wrap_u, Texture::Wrap::mirror);
  EXPECT_EQ(look->paint->wrap_v, Texture::Wrap::clamp);
  EXPECT_FALSE(look->paint->smooth);
  EXPECT_EQ(look->paint->factor, painted.material.base_color);
  EXPECT_EQ(look->paint->cutoff, 0) << "opaque: alpha does not count";
  EXPECT_EQ(look->paint->coordinates, painted.coordinates);
  EXPECT_EQ(look->paint->image, painted.images.begin()->second) << "shared, not copied";
}

TEST(SurfaceLook, WithoutAImageOrCoordinatesItIsThePlainColour) {
  Painted painted;
  painted.coordinates = nullptr;
  EXPECT_EQ(painted.look()->paint, nullptr);
  EXPECT_EQ(painted.look()->colour, render::colour(0xFFBC00));
  painted = Painted();
  painted.images.begin()->second = nullptr;  // could not be decoded
  EXPECT_EQ(painted.look()->paint, nullptr);
  painted = Painted();
  painted.material.base_color_texture = {};
  EXPECT_EQ(painted.look()->paint, nullptr);
}

TEST(SurfaceLook, MaskCutsByItsCutoffAndBlendByHalf) {
  Painted painted;
  painted.material.alpha = Material::Alpha::mask;
  painted.material.alpha_cutoff = 0.3F;
  ASSERT_TRUE(painted.look() && painted.look()->paint);
  EXPECT_EQ(painted.look()->paint->cutoff, 0.3F);
  painted.material.alpha_cutoff = 0.41F;  // more than the factor: nothing of it is drawn
  EXPECT_FALSE(painted.look());
  painted.material.alpha = Material::Alpha::blend;
  EXPECT_FALSE(painted.look());
  painted.material.base_color.w() = 0.6F;
  ASSERT_TRUE(painted.look() && painted.look()->paint);
  EXPECT_EQ(painted.look()->paint->cutoff, 0.5F);
}

// Each part has its own vertices: the coordinates go with them.
TEST(SurfaceLook, ABodysPartsHaveTheCoordinatesOfTheirVertices) {
  Painted painted;
  Model model;
  model.skeleton.add("root", -1, Transform());
  model.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  model.texture_coordinates = {{0, 1}, {1, 1}, {0, 0}, {1, 0}};
  model.influences_per_vertex = 1;
  model.influence_joints.assign(4, 0);
  model.influence_weights.assign(4, 1);
  model.triangles = {{0, 1, 2}, {3, 2, 1}};
  model.parts = {{"a", "Other", 0, 1}, {"b", "Skin", 1, 1}};
  ASSERT_TRUE(check(model).ok());
  Actor actor;
  actor.model = model;
  actor.materials = {painted.material};
  const DrawnScene body(
      scene_of(std::make_shared<const Actor>(std::move(actor)), {.by_part = true}), painted.images);
  SceneState state;
  body.scene().evaluate(-1, 0, state);
  const auto surfaces = body.at(state).surfaces;
  ASSERT_EQ(surfaces.size(), 2u);
  EXPECT_EQ(surfaces[0].paint, nullptr);
  ASSERT_NE(surfaces[1].paint, nullptr);
  const auto& corners = (*surfaces[1].triangles)[0];
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ((*surfaces[1].paint->coordinates)[corners[k]],
              model.texture_coordinates[model.triangles[1][k]]);
  }
  EXPECT_EQ(body.at(state).surfaces[1].paint, surfaces[1].paint) << "the moments share it";
}

}  // namespace
}  // namespace krok::cli
