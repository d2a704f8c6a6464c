// krok-view on a .character. If these fail, a character is shown without its materials, with a face
// that it has not at rest, or stands still beside the motion that should move it.

#include <cstring>

#include "cli/hero_character.h"
#include "formats/morph_exr/morph_exr.h"
#include "shown_page.h"

namespace krok::test {
namespace {

class ViewCharacter : public HeroCharacter {
 protected:
  // What a page of these files shows.
  json shown(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-o", "page.html"});
    tool("krok-view", arguments);
    return data_of(get(path("page.html")))["items"];
  }

  // The bytes of an array that the page just made has for its first body.
  std::string array(const json& place, std::size_t value_size) {
    return bytes_of_base64(element_of(get(path("page.html")), "krok-body-0"))
        .substr(place["offset"], place["count"].get<std::size_t>() * value_size);
  }

  std::vector<Vec3f> positions(const json& item) {
    const std::string bytes = array(item["body"]["positions"], sizeof(float));
    std::vector<Vec3f> result(bytes.size() / sizeof(Vec3f));
    std::memcpy(static_cast<void*>(result.data()), bytes.data(), bytes.size());
    return result;
  }
};

TEST_F(ViewCharacter, HasItsMaterialsAndImages) {
  const json items = shown({"hero.character", "--json=report.json"});
  ASSERT_EQ(items.size(), 1u);
  EXPECT_EQ(items[0]["name"], "hero.character");
  EXPECT_EQ(items[0]["frames"], 0);
  const json look = items[0]["body"]["look"];
  ASSERT_EQ(look["materials"].size(), 1u);
  EXPECT_EQ(look["materials"][0]["roughness"], 0.25);
  ASSERT_EQ(look["pictures"].size(), 1u);
  EXPECT_EQ(look["pictures"][0]["type"], "image/png");
  EXPECT_EQ(array(look["pictures"][0], 1), get(path("skin.png")));
  EXPECT_EQ(look["parts"][0]["count"], items[0]["body"]["triangles"]["count"]);
  const json report = json::parse(get(path("report.json")));
  EXPECT_EQ(report["result"]["motions"][0]["materials"], 1);
  EXPECT_EQ(report["inputs"].size(), 5u);  // all that the character names
}

TEST_F(ViewCharacter, HasTheFaceThatItHasAtRest) {
  const auto file = InputFile::open(path("bent.exr"));
  ASSERT_TRUE(file.ok());
  const auto morphs = morph_exr::read(file->bytes());
  ASSERT_TRUE(morphs.ok());
  const auto bowing = positions(shown({"hero.character"})[0]);
  ASSERT_EQ(bowing.size(), morphs->positions.size());
  for (std::size_t v = 0; v < bowing.size(); ++v) {
    ASSERT_EQ(bowing[v], morphs->positions[v]) << v;
  }
  put_character(kUpright);
  const auto upright = positions(shown({"hero.character"})[0]);
  EXPECT_EQ(upright, positions(shown({"in.model"})[0]));
  EXPECT_NE(upright, bowing);
}

TEST_F(ViewCharacter, AMotionOfItsSkeletonMovesIt) {
  const json items = shown({"hero.character", "in.anim"});
  ASSERT_EQ(items.size(), 1u);
  EXPECT_EQ(items[0]["name"], "in.anim");
  EXPECT_EQ(items[0]["frames"], 20);
  EXPECT_TRUE(items[0]["body"].contains("look"));
  // A model shows none.
  EXPECT_FALSE(shown({"in.model", "in.anim"})[0]["body"].contains("look"));
}

TEST_F(ViewCharacter, IsFoundInAFolder) {
  // Beside it in.bvh and in.anim, both of its skeleton.
  const json items = shown({"."});
  ASSERT_EQ(items.size(), 2u + 1u);  // bent.glb too
  EXPECT_TRUE(items[0]["body"].contains("look"));
  EXPECT_TRUE(items[1]["body"].contains("look"));
}

TEST_F(ViewCharacter, SaysWhatIsWrongWithIt) {
  put_character("[]", "../in.model");
  const std::string told = tool("krok-view", {"hero.character", "-o", "page.html"}, 2).err;
  EXPECT_NE(told.find("hero.character:1:"), std::string::npos) << told;
  EXPECT_TRUE(has_code(told, "character-path")) << told;
  EXPECT_FALSE(std::filesystem::exists(path("page.html")));
}

}  // namespace
}  // namespace krok::test
