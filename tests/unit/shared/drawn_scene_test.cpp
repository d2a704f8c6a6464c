// If these fail, pictures of characters have parts in the wrong colour or place, or show what is
// behind glass as if the glass were a wall.

#include "tools/shared/drawn_scene.h"

#include <gtest/gtest.h>

#include "golden/samples/samples.h"
#include "skin/scene_of.h"
#include "tools/shared/bone_actor.h"

namespace krok::cli {
namespace {

// Two triangles that share two of their four vertices, a part each.
std::shared_ptr<const Model> two_parts() {
  Model model = samples::model();
  model.parts[0].material = "Red";
  model.parts[1].material = "Glass";
  return std::make_shared<const Model>(std::move(model));
}

Material material(const std::string& name, const Vec4f& colour) {
  Material made;
  made.name = name;
  made.base_color = colour;
  return made;
}

Material glass(float alpha) {
  Material made = material("Glass", Vec4f(0, 0, 1, alpha));
  made.alpha = Material::Alpha::blend;
  return made;
}

std::vector<render::Surface> drawn(const std::shared_ptr<const Model>& model,
                                   const std::vector<Material>& materials) {
  Actor actor;
  actor.model = *model;
  actor.materials = materials;
  const bool painted = !materials.empty() || !model->colours.empty();
  const DrawnScene drawn(
      scene_of(std::make_shared<const Actor>(std::move(actor)), {.by_part = painted}), {});
  SceneState state;
  drawn.scene().evaluate(-1, 0, state);
  return drawn.at(state).surfaces;
}

TEST(DrawnScene, WithoutMaterialsIsOneSurface) {
  const auto model = two_parts();
  const auto surfaces = drawn(model, {});
  ASSERT_EQ(surfaces.size(), 1u);
  EXPECT_EQ(*surfaces[0].triangles, model->triangles);
  EXPECT_EQ(surfaces[0].colours, std::vector{kBodyColour});
  ASSERT_EQ(surfaces[0].positions.size(), 4u);
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_LT((surfaces[0].positions[v] - model->positions[v]).norm(), 1e-5F);
  }
}

// Painted characters would be drawn in one colour.
TEST(DrawnScene, VertexColoursMultiplyTheMaterial) {
  Model painted = *two_parts();
  painted.colours = {Vec4f(1, 1, 1, 1), Vec4f(0.5F, 1, 0, 1), Vec4f(0, 0, 0, 1), Vec4f(0, 0, 1, 1)};
  const auto model = std::make_shared<const Model>(painted);
  const auto plain = drawn(model, {});
  ASSERT_EQ(plain.size(), 2u);
  EXPECT_EQ(plain[0].colours, (std::vector{render::colour(0xFFFFFF), render::colour(0xBCFF00),
                                           render::colour(0x000000)}));
  const auto surfaces = drawn(model, {material("Red", Vec4f(1, 0, 0, 1))});
  EXPECT_EQ(surfaces[0].colours, (std::vector{render::colour(0xFF0000), render::colour(0xBC0000),
                                              render::colour(0x000000)}));
}

TEST(DrawnScene, EachPartHasItsColourAndItsOwnVertices) {
  const auto model = two_parts();
  // Half of the light is 188 of 255 on a screen (sRGB).
  const auto surfaces =
      drawn(model, {material("Red", Vec4f(1, 0.5F, 0, 1)), material("Glass", Vec4f(0, 0, 1, 1))});
  ASSERT_EQ(surfaces.size(), 2u);
  EXPECT_EQ(surfaces[0].colours, std::vector{render::colour(0xFFBC00)});
  EXPECT_EQ(surfaces[1].colours, std::vector{render::colour(0x0000FF)});
  for (std::size_t part = 0; part < 2; ++part) {
    ASSERT_EQ(surfaces[part].positions.size(), 3u);
    ASSERT_EQ(surfaces[part].normals.size(), 3u);
    ASSERT_EQ(surfaces[part].triangles->size(), 1u);
    const auto& corners = (*surfaces[part].triangles)[0];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& expected = model->positions[model->triangles[part][k]];
      EXPECT_LT((surfaces[part].positions[corners[k]] - expected).norm(), 1e-5F) << part << k;
    }
  }
}

TEST(DrawnScene, APartOfNoMaterialIsLightGrey) {
  const auto surfaces = drawn(two_parts(), {material("Red", Vec4f(1, 0, 0, 1))});
  ASSERT_EQ(surfaces.size(), 2u);
  EXPECT_EQ(surfaces[1].colours, std::vector{render::colour(0xE7E7E7)});  // 0.8 of the light
}

TEST(DrawnScene, GlassIsLeftOutUnlessThereIsNothingElse) {
  const std::vector red_and_glass = {material("Red", Vec4f(1, 0, 0, 1)), glass(0.25F)};
  EXPECT_EQ(drawn(two_parts(), red_and_glass).size(), 1u);
  EXPECT_EQ(drawn(two_parts(), {material("Red", Vec4f(1, 0, 0, 1)), glass(0.75F)}).size(), 2u);
  Model model = *two_parts();
  model.parts[0].material = "Glass";
  const auto all = drawn(std::make_shared<const Model>(std::move(model)), red_and_glass);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].colours, std::vector{kBodyColour});
  EXPECT_EQ(all[1].colours, std::vector{kBodyColour});
}

}  // namespace
}  // namespace krok::cli
