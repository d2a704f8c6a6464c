// If these fail, text files of version 1 that users have are read differently than before, or what
// is written has changed.

#include <gtest/gtest.h>

#include "core/file.h"
#include "formats/character/character_format.h"
#include "formats/material/material_format.h"
#include "golden/samples/samples.h"
#include "support/this_build.h"

namespace krok {
namespace {

std::string frozen(const std::string& name) {
  const auto file = InputFile::open(test::source_folder() + "/tests/golden/v1/" + name);
  EXPECT_TRUE(file.ok()) << name;
  return file ? std::string(file->text()) : std::string();
}

void expect_same(const Texture& found, const Texture& expected) {
  ASSERT_EQ(static_cast<bool>(found), static_cast<bool>(expected));
  if (!expected) return;
  EXPECT_EQ(found.image->path, expected.image->path);
  EXPECT_EQ(found.wrap_u, expected.wrap_u);
  EXPECT_EQ(found.wrap_v, expected.wrap_v);
  EXPECT_EQ(found.smooth, expected.smooth);
}

TEST(FrozenFiles, MaterialsHoldEveryValue) {
  const auto found = material::read(frozen("full.material"));
  ASSERT_TRUE(found.ok()) << found.error().message;
  const std::vector<Material> expected = samples::materials();
  ASSERT_EQ(found->size(), expected.size());
  for (std::size_t m = 0; m < expected.size(); ++m) {
    const Material &a = (*found)[m], &b = expected[m];
    SCOPED_TRACE(b.name);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.base_color, b.base_color);
    EXPECT_EQ(a.metallic, b.metallic);
    EXPECT_EQ(a.roughness, b.roughness);
    EXPECT_EQ(a.normal_scale, b.normal_scale);
    EXPECT_EQ(a.occlusion_strength, b.occlusion_strength);
    EXPECT_EQ(a.emissive, b.emissive);
    EXPECT_EQ(a.alpha, b.alpha);
    EXPECT_EQ(a.alpha_cutoff, b.alpha_cutoff);
    EXPECT_EQ(a.double_sided, b.double_sided);
    EXPECT_EQ(a.unlit, b.unlit);
    EXPECT_EQ(a.shaders, b.shaders);
    const auto textures = textures_of(a), others = textures_of(b);
    for (std::size_t t = 0; t < textures.size(); ++t) expect_same(*textures[t], *others[t]);
  }
  // One file, one picture.
  EXPECT_EQ((*found)[0].base_color_texture.image, (*found)[3].base_color_texture.image);
  EXPECT_EQ(*material::write(*found), frozen("full.material"));
  EXPECT_EQ(*material::write(expected), frozen("full.material"));
}

TEST(FrozenFiles, CharactersHoldEveryValue) {
  const auto found = character_file::read(frozen("full.character"));
  ASSERT_TRUE(found.ok()) << found.error().message;
  const Character expected = samples::character();
  EXPECT_EQ(found->name, expected.name);
  EXPECT_EQ(found->model, expected.model);
  EXPECT_EQ(found->materials, expected.materials);
  ASSERT_EQ(found->parts.size(), expected.parts.size());
  for (std::size_t p = 0; p < expected.parts.size(); ++p) {
    EXPECT_EQ(found->parts[p].name, expected.parts[p].name);
    EXPECT_EQ(found->parts[p].material, expected.parts[p].material);
  }
  ASSERT_EQ(found->eyes.size(), expected.eyes.size());
  for (std::size_t e = 0; e < expected.eyes.size(); ++e) {
    EXPECT_EQ(found->eyes[e].name, expected.eyes[e].name);
    EXPECT_EQ(found->eyes[e].joint, expected.eyes[e].joint);
    EXPECT_EQ(found->eyes[e].position, expected.eyes[e].position);
  }
  EXPECT_EQ(found->morphs, expected.morphs);
  ASSERT_EQ(found->expressions.size(), expected.expressions.size());
  for (std::size_t e = 0; e < expected.expressions.size(); ++e) {
    EXPECT_EQ(found->expressions[e].name, expected.expressions[e].name);
    EXPECT_EQ(found->expressions[e].target, expected.expressions[e].target);
    EXPECT_EQ(found->expressions[e].weight, expected.expressions[e].weight);
  }
  EXPECT_EQ(found->role_map, expected.role_map);
  EXPECT_EQ(*character_file::write(*found), frozen("full.character"));
  EXPECT_EQ(*character_file::write(expected), frozen("full.character"));
}

}  // namespace
}  // namespace krok
