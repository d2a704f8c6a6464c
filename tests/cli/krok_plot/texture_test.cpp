// krok-plot --sheet of what has pictures on it. If these fail, a character's texture is missing,
// turned, in another colour, or a damaged one stops the tool.

#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "support/glb_builder.h"
#include "support/image.h"
#include "support/small_images.h"

namespace krok::test {
namespace {

class PlotTexture : public CliTest {
 protected:
  // A square metre of two joints, standing in x and y from 0 to 1, that shows a picture as it is:
  // four squares, red and green above blue and white. With another material than the usual one, its
  // members.
  static GlbBuilder painted(std::vector<std::byte> image, const json& members = json::object()) {
    GlbBuilder builder = rig();
    builder.json.erase("animations");
    auto& primitive = builder.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] =
        builder.add(std::vector<float>{0, 1, 1, 1, 1, 0, 0, 0}, "VEC2");
    primitive["material"] = 0;
    builder.json["images"] = {{{"bufferView", builder.add_view(image)}, {"mimeType", "image/png"}}};
    builder.json["samplers"] = {{{"magFilter", 9728}}};  // nearest
    builder.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
    builder.json["materials"] = {
        {{"name", "Skin"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    for (const auto& [name, value] : members.items()) builder.json["materials"][0][name] = value;
    return builder;
  }

  std::string put_glb(const GlbBuilder& builder) const {
    return put("in.glb", text_of(builder.glb()));
  }

  struct Shot {
    render::Image image;
    json sheet;
    std::string told;
    // At a place of the square.
    render::Colour at(double x, double y) const {
      const Vec2 place = place_in(sheet["cells"][0], sheet["pixels_per_metre"], Vec3(x, y, 0));
      return image.at(static_cast<int>(place.x()), static_cast<int>(place.y()));
    }
  };
  Shot shot(const std::string& input, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {
        input,     "--sheet", path("s.png"), "--view", "front",
        "--front", "world",   "--moments",   "1",      "--json=" + path("report.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ToolRun run = run_tool("krok-plot", arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    auto image = image_of(get(path("s.png")));
    EXPECT_TRUE(image.ok());
    return {image ? std::move(*image) : render::Image(),
            json::parse(get(path("report.json")))["result"]["sheet"], run.err};
  }

  static void expect_four_colours(const Shot& shot) {
    const render::Colour red = shot.at(0.25, 0.75), green = shot.at(0.75, 0.75);
    const render::Colour blue = shot.at(0.25, 0.25), white = shot.at(0.75, 0.25);
    EXPECT_GT(red.red, 150);
    EXPECT_LT(red.green + red.blue, 40);
    EXPECT_GT(green.green, 150);
    EXPECT_LT(green.red + green.blue, 40);
    EXPECT_GT(blue.blue, 150);
    EXPECT_LT(blue.red + blue.green, 40);
    EXPECT_GT(white.red, 150);
    EXPECT_LT(colourfulness(white), 10);
  }

  // All over in the colour of bodies, a light brown.
  static void expect_plain(const Shot& shot) {
    for (const auto& [x, y] : {std::pair(0.25, 0.75), {0.75, 0.75}, {0.25, 0.25}, {0.75, 0.25}}) {
      const render::Colour colour = shot.at(x, y);
      EXPECT_GT(colour.red, colour.green);
      EXPECT_GT(colour.green, colour.blue);
      EXPECT_LT(colourfulness(colour), 60);
    }
  }
};

TEST_F(PlotTexture, AGlbShowsItsImage) {
  const Shot found = shot(put_glb(painted(png())));
  expect_four_colours(found);
  EXPECT_EQ(found.told.find("warning"), std::string::npos) << found.told;
}

TEST_F(PlotTexture, ACharacterShowsTheImageOfItsMaterial) {
  put_glb(painted(png()));
  ASSERT_EQ(run_tool("krok-import", {path("in.glb"), "--save-character", path("hero.character")})
                .exit_code,
            0);
  expect_four_colours(shot(path("hero.character")));
}

TEST_F(PlotTexture, AnyNumberOfThreadsGivesTheSameBytes) {
  const std::string input = put_glb(painted(png()));
  shot(input, {"-j", "1", "--elevation", "30deg"});
  const std::string one = get(path("s.png"));
  shot(input, {"-j", "4", "--elevation", "30deg"});
  EXPECT_EQ(one, get(path("s.png")));
}

TEST_F(PlotTexture, AFactorDarkensTheImage) {
  const json factor = {
      {"pbrMetallicRoughness",
       {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {0.25, 0.25, 0.25, 1}}}}};
  const Shot whole = shot(put_glb(painted(png())));
  const Shot dark = shot(put_glb(painted(png(), factor)));
  // A quarter of the light is 0.54 of the number on a screen (sRGB).
  EXPECT_NEAR(dark.at(0.25, 0.75).red, 0.54 * whole.at(0.25, 0.75).red, 8);
}

// The square with a colour at each vertex and no image: as krok-diff --heatmap writes.
TEST_F(PlotTexture, VertexColoursAreShown) {
  GlbBuilder builder = rig();
  builder.json.erase("animations");
  // Red below, blue above.
  const std::vector<float> colours = {1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1};
  builder.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      builder.add(colours, "VEC3");
  const Shot plain = shot(put_glb(builder));
  const render::Colour below = plain.at(0.5, 0.1), above = plain.at(0.5, 0.9);
  EXPECT_GT(below.red, 2 * below.blue);
  EXPECT_GT(above.blue, 2 * above.red);
  EXPECT_LT(below.green + above.green, 20);
  // With an image, they multiply it: only what is red of it is left.
  GlbBuilder textured = painted(png());
  textured.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      textured.add(std::vector<float>{1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
  const Shot both = shot(put_glb(textured));
  EXPECT_GT(both.at(0.25, 0.75).red, 150);
  EXPECT_LT(both.at(0.75, 0.75).green, 20);
  EXPECT_GT(both.at(0.75, 0.25).red, 150);
  EXPECT_LT(both.at(0.75, 0.25).green + both.at(0.75, 0.25).blue, 20);
}

// White surfaces with the normals of a ball: towards the light, towards the viewer, away to the
// right. Each is darker than the one before, and none is the white of paper, where the shape would
// be lost.
TEST_F(PlotTexture, WhiteSurfacesKeepTheirShape) {
  std::vector<int> greys;
  for (const Vec3f& normal : {Vec3f(-0.464F, 0.649F, 0.603F), Vec3f(0, 0, 1),
                              Vec3f(0.5F, 0, 0.866F), Vec3f(0.866F, 0, 0.5F)}) {
    GlbBuilder builder = rig();
    builder.json.erase("animations");
    auto& attributes = builder.json["meshes"][0]["primitives"][0]["attributes"];
    std::vector<float> normals;
    for (int v = 0; v < 4; ++v) {
      normals.insert(normals.end(), {normal.x(), normal.y(), normal.z()});
    }
    attributes["NORMAL"] = builder.add(normals, "VEC3");
    attributes["COLOR_0"] = builder.add(std::vector<float>(12, 1.0F), "VEC3");
    greys.push_back(shot(put_glb(builder)).at(0.5, 0.5).green);
  }
  EXPECT_LT(greys[0], 254);
  EXPECT_GT(greys[3], 150);
  for (std::size_t i = 1; i < greys.size(); ++i) EXPECT_LT(greys[i], greys[i - 1]) << i;
}

// As their .character does.
TEST_F(PlotTexture, FilesWithoutImagesHaveTheirBaseColours) {
  GlbBuilder builder = painted(png());
  builder.json["materials"][0]["pbrMetallicRoughness"] = {{"baseColorFactor", {0, 1, 0, 1}}};
  const render::Colour green = shot(put_glb(builder)).at(0.25, 0.75);
  EXPECT_GT(green.green, green.red + 60);
  EXPECT_GT(green.green, green.blue + 60);
  // One grey for all, which exporters write by themselves, is the colour of bodies.
  builder.json["materials"][0]["pbrMetallicRoughness"] = {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}};
  expect_plain(shot(put_glb(builder)));
}

TEST_F(PlotTexture, ADamagedImageIsToldAndThePlainColourShows) {
  std::vector<std::byte> damaged = png();
  damaged[50] ^= std::byte{0xFF};  // within the pixels: found only where they are decoded
  const Shot found = shot(put_glb(painted(damaged)));
  EXPECT_TRUE(has_code(found.told, "picture-damaged")) << found.told;
  EXPECT_NE(found.told.find("'Skin'"), std::string::npos) << found.told;
  expect_plain(found);
}

TEST_F(PlotTexture, AImageTooLargeIsToldAndTakesNoMemory) {
  std::vector<std::byte> huge = png();
  huge[18] = huge[22] = std::byte{0x7F};  // 32514 a side
  const Shot found = shot(put_glb(painted(huge)));
  EXPECT_TRUE(has_code(found.told, "picture-size")) << found.told;
  expect_plain(found);
}

TEST_F(PlotTexture, BonesNeedNoImages) {
  std::vector<std::byte> damaged = png();
  damaged[50] ^= std::byte{0xFF};
  const std::string told = shot(put_glb(painted(damaged)), {"--body", "none"}).told;
  EXPECT_EQ(told.find("warning"), std::string::npos) << told;
}

}  // namespace
}  // namespace krok::test
