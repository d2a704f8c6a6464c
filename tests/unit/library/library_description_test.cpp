// If these fail, a step library is made of other motions, or measures other things, than its
// description says, or a mistake in the description is passed over or reported at the wrong place.

#include "formats/library/library_description.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <numbers>

#include "support/this_build.h"
#include "support/told_mistakes.h"

namespace krok::library {
namespace {

constexpr const char* kGood = R"({
  "schema": "krok.library/1",
  "name": "walking", "skeleton": "rest.anim", "map": "roles.json",
  "swing": "right", "mirror": true, "rate": 60,
  "outlier_deviations": 3, "spacing": 0.05,
  "parameters": [
    {"name": "stride", "measures": "step.length", "tolerance": "1mm", "from": "45cm", "to": 0.8},
    {"measures": "step.turn", "from": -10, "to": "0.5rad"},
    {"measures": "duration", "tolerance": "5ms"}
  ],
  "steps": "auto",
  "examples": [
    {"clip": "walks/*.bvh", "from": "1.5s", "to": "90f", "style": "old"},
    {"clip": "one.anim", "name": "slow", "steps": "one", "keys": "one.json",
     "keytimes": {"begin": 0, "touch": "250ms", "end": "40f"}}
  ]
})";

TEST(LibraryDescription, ReadsWhatTheSpecSays) {
  const auto read = library::read(kGood, "walk.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->name, "walking");
  EXPECT_EQ(read->skeleton, "rest.anim");
  EXPECT_EQ(read->map, "roles.json");
  EXPECT_EQ(read->swing, Side::right);
  EXPECT_TRUE(read->mirror);
  EXPECT_EQ(read->rate, 60.0);
  EXPECT_EQ(read->outlier_deviations, 3.0);
  EXPECT_EQ(read->spacing, 0.05);
  EXPECT_TRUE(read->keytimes.empty());

  ASSERT_EQ(read->parameters.size(), 3u);
  const ParameterEntry& length = read->parameters[0];
  EXPECT_EQ(length.name, "stride");
  EXPECT_EQ(length.measures, "step.length");
  EXPECT_NEAR(*length.tolerance, 0.001, 1e-15);
  EXPECT_NEAR(*length.least, 0.45, 1e-15);
  EXPECT_NEAR(*length.most, 0.8, 1e-15);
  EXPECT_EQ(length.place.line, 7);
  EXPECT_EQ(length.place.column, 5);
  EXPECT_EQ(length.place.file, "walk.json");
  const ParameterEntry& turn = read->parameters[1];
  EXPECT_EQ(turn.name, "turn");
  EXPECT_FALSE(turn.tolerance.has_value());
  EXPECT_NEAR(*turn.least, -10 * std::numbers::pi / 180, 1e-15);  // a bare angle is degrees
  EXPECT_NEAR(*turn.most, 0.5, 1e-15);
  EXPECT_EQ(read->parameters[2].name, "duration");
  EXPECT_NEAR(*read->parameters[2].tolerance, 0.005, 1e-15);
  EXPECT_FALSE(read->parameters[2].least.has_value());

  ASSERT_EQ(read->examples.size(), 2u);
  EXPECT_EQ(read->examples[0].style, "old");
  EXPECT_EQ(read->examples[1].style, "");
  const ExampleEntry& walks = read->examples[0];
  EXPECT_EQ(walks.clip, "walks/*.bvh");
  EXPECT_TRUE(walks.automatic);
  EXPECT_EQ(walks.from->seconds(30), 1.5);
  EXPECT_EQ(walks.to->seconds(30), 3.0);
  const ExampleEntry& one = read->examples[1];
  EXPECT_EQ(one.name, "slow");
  EXPECT_FALSE(one.automatic);
  EXPECT_EQ(one.keys, "one.json");
  EXPECT_EQ(one.place.line, 14);
  ASSERT_EQ(one.keytimes.size(), 3u);
  EXPECT_EQ(one.keytimes[0].name, "begin");
  EXPECT_EQ(one.keytimes[1].time.seconds(60), 0.25);
  EXPECT_EQ(one.keytimes[2].time.seconds(20), 2.0);
}

// Would fail if a turn of the path were read as a length, so that its tolerance refused degrees.
TEST(LibraryDescription, TurnsAreAngles) {
  for (const char* turn : {"step.turn", "step.path_turn", "step.path_turn@end"}) {
    const std::string text = fmt::format(
        R"({{"schema": "krok.library/1", "examples": [{{"clip": "a.anim"}}],
            "parameters": [{{"measures": "{}", "tolerance": "0.1deg", "from": "-20deg",
              "to": "20deg"}}]}})",
        turn);
    const auto read = library::read(text, "walk.json");
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_NEAR(*read->parameters[0].tolerance, 0.1 * std::numbers::pi / 180, 1e-15) << turn;
    EXPECT_NEAR(*read->parameters[0].least, -20 * std::numbers::pi / 180, 1e-15) << turn;
  }
}

TEST(LibraryDescription, WhatIsLeftOutHasItsDefault) {
  const auto read = library::read(R"({"schema": "krok.library/1", "comment": [1, {}],
    "keytimes": ["begin", "end"], "parameters": [{"measures": "LeftHand.up@end"}],
    "examples": [{"clip": "a.anim"}]})",
                                  "");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->swing, Side::left);
  EXPECT_FALSE(read->mirror);
  EXPECT_FALSE(read->rate.has_value());
  EXPECT_FALSE(read->outlier_deviations.has_value());
  EXPECT_FALSE(read->spacing.has_value());
  EXPECT_EQ(read->keytimes, (std::vector<std::string>{"begin", "end"}));
  EXPECT_EQ(read->parameters[0].name, "up@end");
  EXPECT_FALSE(read->examples[0].automatic);
  EXPECT_FALSE(read->examples[0].from.has_value());
}

// The page must not promise what the reader refuses.
TEST(LibraryDescription, ReadsTheExamplesOfItsPage) {
  std::ifstream file(test::source_folder() + "/formats/library/SPEC.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  int examples = 0;
  for (std::size_t at = page.find("```json"); at != std::string::npos;
       at = page.find("```json", at + 1)) {
    const std::size_t begin = page.find('\n', at);
    const auto result = read(page.substr(begin, page.find("```", begin) - begin), "SPEC.md");
    EXPECT_TRUE(result.ok()) << result.error().message;
    ++examples;
  }
  EXPECT_EQ(examples, 2);
}

// Runs have other keytimes than walks, so that one library has either.
TEST(LibraryDescription, RunsAreForTheWholeFile) {
  const std::string head = R"({"schema": "krok.library/1", "parameters": [{"measures": "duration"}],
    "steps": )";
  const auto runs = library::read(head + R"("runs", "examples": [{"clip": "a.bvh"}]})", "l.json");
  ASSERT_TRUE(runs.ok()) << runs.error().message;
  EXPECT_EQ(runs->kind, library::StepKind::runs);
  EXPECT_TRUE(runs->examples[0].automatic);
  for (const auto& [word, kind] : {std::pair{"backward", library::StepKind::backward},
                                   std::pair{"side", library::StepKind::side},
                                   std::pair{"side_closing", library::StepKind::side_closing},
                                   std::pair{"turns", library::StepKind::turns},
                                   std::pair{"turns_closing", library::StepKind::turns_closing}}) {
    const auto other =
        library::read(head + "\"" + word + R"(", "examples": [{"clip": "a.bvh"}]})", "l.json");
    ASSERT_TRUE(other.ok()) << word;
    EXPECT_EQ(other->kind, kind) << word;
    EXPECT_TRUE(other->examples[0].automatic) << word;
  }
  const auto walks = library::read(head + R"("auto", "examples": [{"clip": "a.bvh"}]})", "l.json");
  ASSERT_TRUE(walks.ok());
  EXPECT_EQ(walks->kind, library::StepKind::walks);
  const auto one = library::read(
      head + R"("auto", "examples": [{"clip": "a.bvh", "steps": "runs"}]})", "l.json");
  EXPECT_FALSE(one.ok());
}

TEST(LibraryDescription, EveryMistakeIsToldWithItsPlace) {
  const test::Mistake mistakes[] = {
      {"library/1", "library/2", "library-structure 2:13", "krok.library/2"},
      {"\"swing\"", "\"swings\"", "library-structure 4:3", "swings"},
      {"\"right\"", "\"middle\"", "library-value 4:12", "left or right"},
      {"\"mirror\": true", "\"mirror\": 1", "library-value 4:31", "true or false"},
      {"\"rate\": 60", "\"rate\": 0", "library-value 4:45", "more than 0"},
      {"\"walking\"", "\"\"", "library-value 3:11", "empty"},
      {"\"outlier_deviations\": 3", "\"outlier_deviations\": -3", "library-value 5:25", "-3"},
      {"\"spacing\": 0.05", "\"spacing\": 2", "library-value 5:39", "0 to 1"},
      {"\"1mm\"", "\"1kg\"", "library-value 7:64", "use one of"},
      {"\"1mm\"", "\"0mm\"", "library-value 7:64", "not positive"},
      {"\"1mm\"", "true", "library-value 7:64", "a string with a unit"},
      {", \"to\": 0.8", "", "library-value 7:5", "one end"},
      {"\"to\": 0.8", "\"to\": 0.1", "library-value 7:93", "empty"},
      {"\"to\": 0.8", "\"too\": 0.8", "library-structure 7:87", "too"},
      {"\"stride\"", "\"a=b\"", "library-value 7:5", "="},
      {"\"stride\"", "\"turn\"", "library-value 8:5", "duplicate parameter"},
      {"\"measures\": \"step.turn\", ", "", "library-structure 8:5", "measures"},
      {"\"5ms\"", "\"5f\"", "library-value 9:43", "frames"},
      {"\"auto\"", "\"all\"", "library-value 11:12",
       "auto, runs, starts, stops, stands, backward, side, side_closing, turns, turns_closing or "
       "one"},
      {"\"clip\": \"walks/*.bvh\", ", "", "library-structure 13:5", "clip"},
      {"\"1.5s\"", "\"1.5m\"", "library-value 13:37", "'m'"},
      {"\"1.5s\"", "-1", "library-value 13:37", "before 0"},
      {"\"1.5s\"", "\"-1s\"", "library-value 13:37", "before 0"},
      {"\"1.5s\"", "null", "library-value 13:37", "expected a time"},
      {"\"begin\": 0", "\"begin\": -1", "library-value 15:28", "before 0"},
      {"\"one\", \"keys\"", "\"auto\", \"keys\"", "library-value 15:18", "cannot have keytimes"},
      {"\"name\": \"slow\",", "\"name\": \"slow\"", "json-syntax 14:41", "JSON"},
  };
  test::expect_told(
      kGood, mistakes, [](const std::string& text) { return read(text, "walk.json"); },
      "walk.json");
}

TEST(LibraryDescription, OtherFormsAreRefused) {
  const std::string head = R"({"schema": "krok.library/1", )";
  const std::string parameters = R"("parameters": [{"measures": "step.length"}])";
  const std::string examples = R"("examples": [{"clip": "a.anim"}])";
  ASSERT_TRUE(read(head + parameters + "," + examples + "}", "").ok());
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string("7"), head + parameters + "}",
        head + examples + "}", head + parameters + R"(, "examples": []})",
        head + examples + R"(, "parameters": []})", head + parameters + R"(, "examples": [7]})",
        head + parameters + "," + examples + R"(, "keytimes": ["one"]})",
        head + parameters + "," + examples + R"(, "keytimes": ["one", "one"]})",
        head + parameters + "," + examples + R"(, "keytimes": ["one", 2]})"}) {
    const auto result = read(text, "");
    EXPECT_FALSE(result.ok()) << text;
    if (result) continue;
    EXPECT_GT(result.error().where.line, 0) << text;
  }
}

}  // namespace
}  // namespace krok::library
