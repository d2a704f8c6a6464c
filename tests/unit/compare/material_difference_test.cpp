// If these fail, a model that lost its texture or changed its colour passes for the same, or one
// that looks the same does not.

#include "compare/material_difference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/small_images.h"

namespace krok::compare {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

Material dressed() {
  Material material;
  material.name = "skin";
  material.base_color = {1, 0.5f, 0.25f, 1};
  material.base_color_texture = {test::image(test::png(), "colour")};
  material.normal_texture = {test::image(test::jpeg(), "detail")};
  material.alpha = Material::Alpha::mask;
  return material;
}

std::vector<std::string> between(const Material& first, const Material& second) {
  return differences(first, second, 1e-4);
}

TEST(MaterialDifferences, NoneWhereOnlyNamesAndObjectsDiffer) {
  Material other = dressed();
  other.name = "another";
  other.base_color_texture.image = test::image(test::png(), "other", "elsewhere/b.png");
  other.base_color.x() -= 5e-5f;
  EXPECT_THAT(between(dressed(), other), IsEmpty());
}

TEST(MaterialDifferences, EachIsTold) {
  const Material plain = dressed();
  const auto told = [&](const auto& change) {
    Material other = plain;
    change(other);
    return between(plain, other);
  };
  EXPECT_THAT(told([](Material& m) { m.base_color.y() = 0.75f; }),
              ElementsAre("base colour 1, 0.5, 0.25, 1 and 1, 0.75, 0.25, 1"));
  EXPECT_THAT(told([](Material& m) { m.metallic = 1; }), ElementsAre("metallic 0 and 1"));
  EXPECT_THAT(told([](Material& m) { m.roughness = 0.5f; }), ElementsAre("roughness 0.8 and 0.5"));
  EXPECT_THAT(told([](Material& m) { m.emissive.z() = 1; }),
              ElementsAre("emissive 0, 0, 0 and 0, 0, 1"));
  EXPECT_THAT(told([](Material& m) { m.normal_scale = 2; }), ElementsAre("normal scale 1 and 2"));
  EXPECT_THAT(told([](Material& m) { m.alpha_cutoff = 0.1f; }),
              ElementsAre("alpha cutoff 0.5 and 0.1"));
  EXPECT_THAT(told([](Material& m) { m.alpha = Material::Alpha::blend; }),
              ElementsAre("alpha mask and blend"));
  EXPECT_THAT(told([](Material& m) { m.double_sided = true; }),
              ElementsAre("double sided no and yes"));
  EXPECT_THAT(told([](Material& m) { m.unlit = true; }), ElementsAre("unlit no and yes"));
  EXPECT_THAT(told([](Material& m) { m.base_color_texture = {}; }),
              ElementsAre("only the first has a base colour texture"));
  EXPECT_THAT(told([](Material& m) { m.occlusion_texture = m.normal_texture; }),
              ElementsAre("only the second has an occlusion texture"));
  EXPECT_THAT(told([](Material& m) { m.normal_texture = m.base_color_texture; }),
              ElementsAre("another normal texture"));
  EXPECT_THAT(told([](Material& m) { m.normal_texture.wrap_v = Texture::Wrap::mirror; }),
              ElementsAre("the normal texture has another sampler"));
  EXPECT_THAT(told([](Material& m) {
                m.metallic = 1;
                m.unlit = true;
              }),
              SizeIs(2));
}

TEST(MaterialDifferences, WhatIsNotUsedDoesNotCount) {
  Material first, second;
  second.normal_scale = 2;        // no normal texture
  second.occlusion_strength = 0;  // no occlusion texture
  second.alpha_cutoff = 0.1f;     // opaque
  EXPECT_THAT(between(first, second), IsEmpty());
}

TEST(MaterialDifferences, WhatIsNoNumberDiffers) {
  Material odd;
  odd.metallic = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(between(odd, odd), SizeIs(1));
}

// A picture outside of the file may not be there.
TEST(MaterialDifferences, ImagesWithoutBytesGoByTheirPaths) {
  Material first, second;
  first.base_color_texture = {test::image({}, {}, "a.png")};
  second.base_color_texture = {test::image({}, {}, "a.png")};
  EXPECT_THAT(between(first, second), IsEmpty());
  second.base_color_texture = {test::image({}, {}, "b.png")};
  EXPECT_THAT(between(first, second), SizeIs(1));
}

}  // namespace
}  // namespace krok::compare
