// If these fail, a named sequence is cut elsewhere than its file says, or a mistake in the file is
// passed over or reported at the wrong place.

#include "formats/sequences/sequences.h"

#include <gtest/gtest.h>

#include "support/told_mistakes.h"

namespace krok::sequences {
namespace {

constexpr const char* kGood = R"({
  "schema": "krok.sequences/1",
  "rate": 60,
  "sequences": [
    {"name": "walk", "first": 120, "last": 187, "loop": true},
    {"name": "wave", "first": 300, "last": 300, "speed": 1.25}
  ]
})";

TEST(Sequences, ReadsWhatTheSpecSays) {
  const auto file = read(kGood);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file->rate, 60);
  ASSERT_EQ(file->sequences.size(), 2u);
  const Sequence* walk = file->find("walk");
  ASSERT_NE(walk, nullptr);
  EXPECT_EQ(walk->first, 120);
  EXPECT_EQ(walk->last, 187);
  EXPECT_EQ(walk->speed, 1);
  EXPECT_TRUE(walk->loop);
  EXPECT_EQ(file->find("wave")->speed, 1.25);
  EXPECT_FALSE(file->find("wave")->loop);
  EXPECT_EQ(file->find("run"), nullptr);
  EXPECT_TRUE(read(R"({"schema":"krok.sequences/1","sequences":[]})")->sequences.empty());
}

TEST(Sequences, EveryMistakeIsToldWithItsPlace) {
  const test::Mistake mistakes[] = {
      {"sequences/1", "sequences/2", "sequences-structure 2:13", "krok.sequences/2"},
      {"\"rate\": 60", "\"rate\": 0", "sequences-value 3:11", "rate"},
      {"\"rate\": 60", "\"rate\": \"60\"", "sequences-value 3:11", "a string"},
      {"\"rate\"", "\"rates\"", "sequences-structure 3:3", "rates"},
      {"\"loop\": true", "\"lop\": true", "sequences-structure 5:49", "lop"},
      {"\"loop\": true", "\"loop\": 1", "sequences-value 5:57", "true or false"},
      {"\"first\": 120", "\"first\": 1.5", "sequences-value 5:31", "1.5"},
      {"\"first\": 120", "\"first\": -1", "sequences-value 5:31", "-1"},
      {"\"first\": 120", "\"first\": 1e12", "sequences-value 5:31", "frame"},
      {"\"last\": 187", "\"last\": 100", "sequences-value 5:44", "before"},
      {"\"last\": 187, ", "", "sequences-structure 5:5", "last"},
      {"\"speed\": 1.25", "\"speed\": -1", "sequences-value 6:58", "speed"},
      {"\"wave\"", "\"walk\"", "sequences-value 6:14", "walk"},
      {"\"wave\"", "\"../wave\"", "sequences-value 6:14", "../wave"},
      {"\"wave\"", "\"\"", "sequences-value 6:14", "name"},
      {"\"wave\"", "7", "sequences-value 6:14", "a number"},
      {"\"wave\",", "\"wave\"", "json-syntax 6:21", "JSON"}};
  test::expect_told(kGood, mistakes, [](const std::string& text) { return read(text); });
  for (const char* text : {"", "[]", "7", "{}", R"({"schema":"krok.sequences/1"})",
                           R"({"schema":"krok.sequences/1","sequences":[7]})"}) {
    EXPECT_FALSE(read(text).ok()) << text;
  }
}

}  // namespace
}  // namespace krok::sequences
