// If these fail, a character's file is misread, or a mistake in it is passed over, reported at the
// wrong place, or fatal.

#include "formats/character/character_format.h"

#include <gtest/gtest.h>

#include "support/told_mistakes.h"

namespace krok::character_file {
namespace {

constexpr const char* kGood = R"({
  "schema": "krok.character/1",
  "model": "hero.model",
  "materials": ["hero.material"],
  "parts": [{"name": "body", "material": "Skin"}],
  "eyes": [{"name": "left", "joint": "Head", "position": [0.03, 1.7, 0.1]}],
  "morphs": "hero.exr",
  "expressions": [{"name": "smile", "weight": 0.5},
                  {"name": "blink", "target": "Eyes"}]
})";

TEST(CharacterFile, ReadsWhatTheSpecSays) {
  const auto character = read(kGood);
  ASSERT_TRUE(character.ok()) << character.error().message;
  EXPECT_EQ(character->name, "");
  EXPECT_EQ(character->model, "hero.model");
  EXPECT_EQ(character->materials, std::vector<std::string>{"hero.material"});
  EXPECT_EQ(character->parts.at(0).material, "Skin");
  EXPECT_EQ(character->eyes.at(0).joint, "Head");
  EXPECT_EQ(character->eyes.at(0).position, Vec3f(0.03f, 1.7f, 0.1f));
  EXPECT_EQ(character->expressions.at(0).weight, 0.5f);
  EXPECT_EQ(character->expressions.at(0).target, "");
  EXPECT_EQ(character->expressions.at(1).target, "Eyes");
  EXPECT_EQ(character->expressions.at(1).weight, 0);
  EXPECT_EQ(character->role_map, "");
  EXPECT_TRUE(check(*character).ok());
}

TEST(CharacterFile, AModelAloneIsEnough) {
  const auto character = read(R"({"schema": "krok.character/1", "model": "a.model"})");
  ASSERT_TRUE(character.ok()) << character.error().message;
  const auto written = write(*character);
  ASSERT_TRUE(written.ok());
  EXPECT_EQ(*write(*read(*written)), *written);
}

TEST(CharacterFile, FaultsAreToldWithTheirPlace) {
  const test::Mistake faults[] = {
      {"\"morphs\"", "\"morps\"", "character-structure 7:3", "did you mean 'morphs'?"},
      {"\"model\": \"hero.model\",", "", "character-structure 1:1", "is missing \"model\""},
      {"hero.model", "../hero.model", "character-path 3:12", "leaves the folder"},
      {"hero.material", "a/../../b", "character-path 4:17", "leaves the folder"},
      {"\"hero.material\"", "3", "character-value 4:17", "expected a file path"},
      {"\"material\": \"Skin\"", "\"materal\": \"Skin\"", "character-structure 5:30",
       "did you mean 'material'?"},
      {"\"Skin\"", "null", "character-value 5:42", "expected a string"},
      {"\"Head\"", "\"\"", "character-value 6:38", "is not a name"},
      {"[0.03, 1.7, 0.1]", "[0.03, 1.7]", "character-value 6:58", "three numbers"},
      {"1.7", "1e9", "character-value 6:58", "three numbers"},
      {"0.5", "1e9", "character-value 8:47", "expected -1000 to 1000"},
      {"\"blink\"", "\"smile\"", "character-value 9:28", "already used"},
      {"  \"morphs\": \"hero.exr\",\n", "", "character-value 7:18", "no \"morphs\""}};
  test::expect_told(kGood, faults, [](const std::string& text) { return read(text); });
}

TEST(CharacterFile, WritingRefusesWhatReadingWould) {
  Character character;
  EXPECT_EQ(write(character).error().code, "character-value");
  character.model = "/a.model";
  EXPECT_EQ(write(character).error().code, "character-path");
  character.model = "a.model";
  character.materials = {"../a.material"};
  EXPECT_EQ(write(character).error().code, "character-path");
}

}  // namespace
}  // namespace krok::character_file
