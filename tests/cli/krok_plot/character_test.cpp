// krok-plot --sheet and --strip of a .character. If these fail, a character is drawn in another
// colour, with another face or in another pose than it has.

#include <nlohmann/json.hpp>

#include "cli/hero_character.h"
#include "support/image.h"

namespace krok::test {
namespace {

class PlotCharacter : public HeroCharacter {
 protected:
  // A picture of the figure and how its one cell is described.
  struct Shot {
    render::Image image;
    json cell;
    Silhouette actor() const { return silhouette(image, cell, 16); }
  };
  Shot sheet(std::vector<std::string> arguments, const std::string& moment = "0s") {
    arguments.insert(arguments.end(), {"--sheet", "s.png", "--moments", moment, "--view", "front",
                                       "--json=report.json"});
    tool("krok-plot", arguments);
    auto image = image_of(get(path("s.png")));
    EXPECT_TRUE(image.ok());
    const json shown = json::parse(get(path("report.json")))["result"]["sheet"];
    EXPECT_EQ(shown["cells"].size(), 1u);
    return {image ? std::move(*image) : render::Image(), shown["cells"][0]};
  }

  // Which pixels two pictures have in different colours.
  static int different(const Shot& a, const Shot& b) {
    int count = 0;
    EXPECT_EQ(a.image.width, b.image.width);
    EXPECT_EQ(a.image.height, b.image.height);
    for (std::size_t i = 0; i < std::min(a.image.rgb.size(), b.image.rgb.size()); i += 3) {
      count += !std::equal(&a.image.rgb[i], &a.image.rgb[i] + 3, &b.image.rgb[i]);
    }
    return count;
  }
};

TEST_F(PlotCharacter, HasTheColourOfItsMaterial) {
  put_material(R"("base_color": [0.02, 0.05, 0.6, 1])");
  const Silhouette blue = sheet({"hero.character"}).actor();
  EXPECT_GT(blue.pixels, 1000);
  EXPECT_EQ(blue.orange_x, 0) << "nothing is more red than blue";
  put_material(R"("base_color": [0.6, 0.05, 0.02, 1])");
  const Silhouette red = sheet({"hero.character"}).actor();
  EXPECT_EQ(red.blue_x, 0);
  EXPECT_NEAR(red.pixels, blue.pixels, 0.02 * blue.pixels);
}

TEST_F(PlotCharacter, StandsWithTheFaceThatItHasAtRest) {
  put_material(R"("base_color": [0.02, 0.05, 0.6, 1])");
  const Silhouette bowing = sheet({"hero.character"}).actor();
  put_character(kUpright);
  const Silhouette upright = sheet({"hero.character"}).actor();
  // Frame 15 leans by 15 degrees at the hips and 15 more above: wider, and less high.
  EXPECT_GT(bowing.right - bowing.left, upright.right - upright.left + 10);
}

TEST_F(PlotCharacter, AMotionMovesItAsAModelOfTheSameShape) {
  // Without materials it is the same picture, pixel for pixel.
  put("hero.character", R"({"schema": "krok.character/1", "model": "in.model"})");
  for (const char* moment : {"0f", "15f"}) {
    const Shot model = sheet({"in.model", "in.anim"}, moment);
    EXPECT_EQ(different(model, sheet({"hero.character", "in.anim"}, moment)), 0) << moment;
  }
  const Silhouette first = sheet({"hero.character", "in.anim"}, "0f").actor();
  const Silhouette later = sheet({"hero.character", "in.anim"}, "15f").actor();
  EXPECT_GT(later.right - later.left, first.right - first.left + 10);
}

TEST_F(PlotCharacter, WhatLetsLightThroughIsLeftOutUnlessItIsAll) {
  // All of the body is one part, so that it is drawn still.
  put_material(R"("base_color": [0, 0, 1, 0.1], "alpha": "blend")");
  EXPECT_GT(sheet({"hero.character"}).actor().pixels, 1000);
}

TEST_F(PlotCharacter, ChartsNeedAMotion) {
  const std::string told = tool("krok-plot", {"hero.character", "-o", "x.svg"}, 2).err;
  EXPECT_NE(told.find("hero.character"), std::string::npos) << told;
  EXPECT_FALSE(std::filesystem::exists(path("x.svg")));
}

}  // namespace
}  // namespace krok::test
