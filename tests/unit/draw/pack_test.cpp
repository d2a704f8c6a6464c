// If these fail, the viewer page shows joints elsewhere than where the motion has them, or its data
// is larger than it may be.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "draw/pack_motion_internal.h"
#include "draw/viewer_page.h"
#include "math/quaternion.h"
#include "support/small_images.h"
#include "support/test_scenes.h"

namespace krok::draw {
namespace {

ViewedMotion viewed(const Clip& clip, std::string name = "a") {
  ViewedMotion motion;
  motion.name = std::move(name);
  motion.clip = &clip;
  return motion;
}

TEST(PackedRotation, ComesBackWithinTheRoundingOfItsBits) {
  std::mt19937 random(7);
  std::normal_distribution<double> number;
  double largest = 0;
  for (int i = 0; i < 20000; ++i) {
    const Quat q = normalized_or_identity(
        Quat(number(random), number(random), number(random), number(random)));
    largest = std::max(largest, angle_between(q, unpack_rotation(pack_rotation(q))));
  }
  EXPECT_LT(largest, 1.5e-4);
  EXPECT_GT(largest, 1e-6);  // it does round
}

TEST(PackedRotation, TakesEachComponentAsTheLargest) {
  for (int i = 0; i < 4; ++i) {
    for (const double sign : {1.0, -1.0}) {
      Quat q(0, 0, 0, 0);
      q.coeffs()[i] = sign;
      EXPECT_LT(angle_between(q, unpack_rotation(pack_rotation(q))), 1.5e-4) << i << " " << sign;
    }
  }
  const Quat even(0.5, 0.5, -0.5, 0.5);  // no single largest
  EXPECT_LT(angle_between(even, unpack_rotation(pack_rotation(even))), 1.5e-4);
}

TEST(PackedMotion, LeavesOutWhatDoesNotMove) {
  Clip clip = test::swinging_clip(test::human_skeleton(), 50, 60);
  Json item;
  Blob blob;
  pack_motion(clip, item, blob);
  EXPECT_EQ(item["moving"], Json::array({0}));  // bones keep their length, the root walks
  EXPECT_EQ(item["turning"].size(), static_cast<std::size_t>(clip.joint_count()));

  for (int f = 1; f < clip.frame_count(); ++f) {
    std::vector<Transform> pose(static_cast<std::size_t>(clip.joint_count()));
    clip.get_pose(0, pose);
    clip.set_pose(f, pose);
  }
  Json still;
  Blob still_blob;
  pack_motion(clip, still, still_blob);
  EXPECT_TRUE(still["moving"].empty());
  EXPECT_TRUE(still["turning"].empty());
  EXPECT_LT(still_blob.base64().size(), 3000U);
}

Material textured(const std::string& name, const std::shared_ptr<const EncodedImage>& image) {
  Material material;
  material.name = name;
  material.base_color_texture.image = image;
  material.base_color_texture.wrap_v = Texture::Wrap::mirror;
  return material;
}

TEST(PackedLook, PartsNameTheirMaterialsAndImagesStandOnce) {
  Model body = test::tube_model(test::human_skeleton());
  body.texture_coordinates.assign(body.positions.size(), Vec2f(0.25f, 0.75f));
  const auto half = static_cast<std::uint32_t>(body.triangles.size() / 2);
  const auto rest = static_cast<std::uint32_t>(body.triangles.size()) - half;
  body.parts = {{"a", "Two", 0, half}, {"b", "None", half, 1}, {"c", "One", half + 1, rest - 1}};
  const auto image = test::image(test::png());
  const std::vector<Material> materials = {textured("One", image), textured("Two", image)};
  Blob blob;
  const auto look = pack_look(body, materials, blob);
  ASSERT_TRUE(look.ok());
  EXPECT_EQ((*look)["parts"], Json::parse(fmt::format(
                                  R"([{{"first": 0, "count": {}, "material": 0}},
          {{"first": {}, "count": 3, "material": 1}}, {{"first": {}, "count": {}, "material": 2}}])",
                                  half * 3, half * 3, half * 3 + 3, (rest - 1) * 3)));
  ASSERT_EQ((*look)["materials"].size(), 3u);
  EXPECT_EQ((*look)["materials"][0]["textures"]["baseColor"]["wrapV"], "mirror");
  EXPECT_EQ((*look)["materials"][1]["color"][0], Material().base_color.x());  // nobody's
  EXPECT_TRUE((*look)["materials"][1]["textures"].empty());
  ASSERT_EQ((*look)["pictures"].size(), 1u);
  EXPECT_EQ((*look)["pictures"][0]["count"], test::png().size());
  ASSERT_EQ((*look)["coordinates"].size(), 1u);
  EXPECT_EQ((*look)["coordinates"][0]["count"], body.positions.size() * 2);
  EXPECT_FALSE(look->contains("colours"));
}

// The page would show ambient occlusion in the wrong places, and painted bodies in one colour.
TEST(PackedLook, FurtherCoordinatesColoursAndTransformsArePacked) {
  Model body = test::tube_model(test::human_skeleton());
  const std::size_t count = body.positions.size();
  body.texture_coordinates.assign(count, Vec2f(0.25f, 0.75f));
  body.more_texture_coordinates = {std::vector<Vec2f>(count, Vec2f(1, 2))};
  body.colours.assign(count, Vec4f::Ones());
  body.parts[0].material = "One";
  Material material = textured("One", test::image(test::png()));
  material.base_color_texture.scale = {2, 4};
  material.base_color_texture.offset = {0.5, 0};
  material.base_color_texture.rotation = kPi / 2;
  material.occlusion_texture = {material.base_color_texture.image};
  material.occlusion_texture.set = 1;
  Blob blob;
  const auto look = pack_look(body, std::vector{material}, blob);
  ASSERT_TRUE(look.ok());
  ASSERT_EQ((*look)["coordinates"].size(), 2u);
  EXPECT_EQ((*look)["colours"]["count"], count * 4);
  const Json& textures = (*look)["materials"][0]["textures"];
  EXPECT_EQ(textures["occlusion"]["set"], 1);
  EXPECT_FALSE(textures["occlusion"].contains("transform"));
  // Where (0, 0), (1, 0) and (0, 1) come to: turned from u towards -v.
  const std::vector<std::vector<double>> places = {{0.5, 0}, {0.5, -2}, {4.5, 0}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(textures["baseColor"]["transform"][i][k].get<double>(), places[i][k], 1e-6);
    }
  }
}

TEST(PackedLook, AMeshWithoutCoordinatesHasNoImages) {
  Model body = test::tube_model(test::human_skeleton());
  body.texture_coordinates.clear();
  body.parts[0].material = "One";
  Blob blob;
  const auto look = pack_look(body, std::vector{textured("One", test::image(test::png()))}, blob);
  ASSERT_TRUE(look.ok());
  EXPECT_TRUE((*look)["materials"][0]["textures"].empty());
  EXPECT_TRUE((*look)["pictures"].empty());
}

TEST(PackedLook, AImageThatIsNoneIsAnError) {
  Model body = test::tube_model(test::human_skeleton());
  body.texture_coordinates.assign(body.positions.size(), Vec2f::Zero());
  body.parts[0].material = "One";
  Blob blob;
  const auto look =
      pack_look(body, std::vector{textured("One", test::image({std::byte{7}}))}, blob);
  ASSERT_FALSE(look.ok());
  EXPECT_EQ(look.error().code, "picture-kind");
}

// A chain of sixty joints that all turn, a minute at 60 frames a second.
TEST(ViewerPage, AMinuteOfSixtyJointsStaysUnderThreeMegabytes) {
  Skeleton chain;
  for (int j = 0; j < 60; ++j) {
    Transform transform;
    transform.position = Vec3(0, 0.02 * j, 0);
    chain.add("joint " + std::to_string(j), j - 1, transform);
  }
  const Clip clip = test::swinging_clip(chain, 3600, 60);
  ViewerPage empty, page;
  Clip nothing;
  nothing.skeleton = chain;
  empty.motions.push_back(viewed(nothing));
  page.motions.push_back(viewed(clip));
  const auto without = write_viewer_page(empty);
  const auto with = write_viewer_page(page);
  ASSERT_TRUE(without.ok() && with.ok());
  EXPECT_LT(with->size() - without->size(), 2'000'000U);
  EXPECT_LT(with->size(), 3'000'000U);
  EXPECT_EQ(*with, *write_viewer_page(page));  // the same bytes again
}

TEST(ViewerPage, NamesCannotEndTheScript) {
  Clip clip = test::swinging_clip(test::human_skeleton(), 2, 60);
  clip.skeleton.names[1] = "</script><script>alert(1)</script>";
  ViewerPage page;
  page.title = "<!--<script>";
  page.motions.push_back(viewed(clip, "</script>"));
  const auto html = write_viewer_page(page);
  ASSERT_TRUE(html.ok());
  EXPECT_EQ(html->find("</script><script>alert"), std::string::npos);
  EXPECT_EQ(html->find("<!--<script>"), std::string::npos);
}

TEST(ViewerPage, RefusesABodyOfAnotherSkeleton) {
  const Clip clip = test::swinging_clip(test::human_skeleton(), 2, 60);
  Skeleton other = test::human_skeleton();
  other.names[3] = "Other";
  const Model body = test::tube_model(other);
  ViewerPage page;
  page.motions.push_back(viewed(clip));
  page.motions[0].body = &body;
  const auto html = write_viewer_page(page);
  ASSERT_FALSE(html.ok());
  EXPECT_EQ(html.error().code, "viewer-body");
}

TEST(ViewerPage, RefusesAContactOfNoJoint) {
  const Clip clip = test::swinging_clip(test::human_skeleton(), 2, 60);
  ViewerPage page;
  page.motions.push_back(viewed(clip));
  page.motions[0].keys.contacts.push_back({clip.joint_count(), 0, 0});
  const auto html = write_viewer_page(page);
  ASSERT_FALSE(html.ok());
  EXPECT_EQ(html.error().code, "keys-joint");
}

}  // namespace
}  // namespace krok::draw
