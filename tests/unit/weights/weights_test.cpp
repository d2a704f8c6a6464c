// If these fail, a face shows other expressions than its file of weights says, or a mistake in the
// file is passed over or reported at the wrong place.

#include "formats/weights/weights.h"

#include <gtest/gtest.h>

#include "formats/csv/csv_writer.h"
#include "support/told_mistakes.h"
#include "support/written_bytes.h"

namespace krok::weights {
namespace {

const std::vector<std::string> kTargets = {"smile", "blink, left", "time"};

constexpr const char* kKeys = R"({
  "schema": "krok.weights/1",
  "rate": 50,
  "between": "smooth",
  "tension": 1,
  "curves": [
    {"target": "time", "between": "linear", "keys": [[0, 0], ["500ms", 1], ["100f", -0.5]]},
    {"target": "smile", "keys": [[1, 0], [2, 1]], "comment": "late"}
  ]
})";

Error error_of(const std::string& text) {
  const auto file = read(text, "w.json", kTargets);
  EXPECT_FALSE(file.ok()) << text;
  return file ? Error() : file.error();
}

TEST(Weights, KeysAreWhatTheSpecSays) {
  const auto file = read(kKeys, "w.json", kTargets);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->rate, 50);
  EXPECT_EQ(file->curves.names, kTargets);
  EXPECT_TRUE(check(file->curves).ok());
  const MorphCurve& smile = file->curves.curves[0];
  EXPECT_EQ(weight_at(smile, 0), 0);
  EXPECT_NEAR(weight_at(smile, 1.25), 0.25 * 0.25 * 2.5, 1e-12);  // rests at both keys
  EXPECT_TRUE(file->curves.curves[1].times.empty());
  const MorphCurve& time = file->curves.curves[2];
  EXPECT_EQ(time.times, (std::vector<double>{0, 0.5, 2}));
  EXPECT_NEAR(weight_at(time, 0.25), 0.5, 1e-12);
  EXPECT_NEAR(weight_at(time, 1.25), 0.25, 1e-12);
}

// If this fails, weights in per cent throw a face a hundred times too far without a word.
TEST(Weights, PerCentIsDoubted) {
  const auto doubted = [](const char* last) {
    std::string text = kKeys;
    text.replace(text.find("[2, 1]"), 6, last);
    const auto file = read(text, "w.json", kTargets);
    EXPECT_TRUE(file.ok());
    return file && implausible_weight(file->curves);
  };
  EXPECT_FALSE(doubted("[2, 1.5]"));
  EXPECT_TRUE(doubted("[2, 80]"));
  EXPECT_TRUE(doubted("[2, -80]"));
}

TEST(Weights, MistakesInKeysAreFoundWhereTheyAre) {
  const test::Mistake mistakes[] = {
      {"weights/1", "weights/2", "weights-structure 2:13"},
      {"\"rate\"", "\"fps\"", "weights-structure 3:3"},
      {"50", "0", "weights-value 3:11"},
      {"\"smooth\"", "\"step\"", "weights-value 4:14"},
      {"\"tension\": 1", "\"tension\": 2", "weights-value 5:14"},
      {"\"time\"", "\"tine\"", "weights-target 7:16"},
      {"\"smile\"", "\"time\"", "weights-structure 8:16"},
      {"\"500ms\"", "\"500 parsecs\"", "weights-value 7:63"},
      {"\"500ms\"", "0", "weights-time 7:63"},
      {"\"500ms\"", "-1", "weights-value 7:63"},
      {"\"500ms\"", "null", "weights-value 7:63"},
      {"\"500ms\", 1", "0.5", "weights-structure 7:62"},
      {"-0.5", "1e7", "weights-value 7:85"},
      {"-0.5", "\"x\"", "weights-value 7:85"},
      {"[[1, 0], [2, 1]]", "[]", "weights-value 8:33"},
      {", \"keys\": [[1, 0], [2, 1]]", "", "weights-structure 8:5"},
      {"  \"rate\": 50,\n", "", "weights-value 6:77"},
      {"]\n}", "", "json-syntax 9:3"},
  };
  test::expect_told(
      kKeys, mistakes, [](const std::string& text) { return read(text, "w.json", kTargets); },
      "w.json");
  EXPECT_EQ(error_of(test::replaced(kKeys, "\"time\"", "\"tine\"")).hint, "did you mean 'time'?");
}

MorphWeights two_frames() {
  return {25, {"time", "smile"}, {0, 0.25f, 1, 0.125f, -2, 0.0625f}};
}

TEST(Weights, ATableOfKroksOwnComesBackToTheBit) {
  Status status;
  const std::string text =
      test::bytes_of([](OutputFile& file) { return csv::write(two_frames(), file); }, status);
  ASSERT_TRUE(status.ok());
  MorphSet morphs;
  morphs.names = {"smile", "blink, left", "time"};
  const auto weights = read_weights(text, "w.csv", morphs);
  ASSERT_TRUE(weights.ok()) << weights.error().message;
  EXPECT_EQ(weights->rate, 25);
  EXPECT_EQ(weights->names, morphs.names);
  EXPECT_EQ(weights->values, (std::vector<float>{0.25f, 0, 0, 0.125f, 0, 1, 0.0625f, 0, -2}));
  // At twice the rate what is between rows stands halfway.
  const auto finer = read_weights(text, "w.csv", morphs, 50.0);
  ASSERT_TRUE(finer.ok());
  EXPECT_EQ(finer->frame_count(), 5);
  EXPECT_FLOAT_EQ(finer->values[3], 0.1875f);
}

TEST(Weights, OddTablesAreRead) {
  const auto file =
      read("time (s);\"blink, left\";smile\n0;1;\n0.5;;2\n2;0;nan\n", "w.csv", kTargets);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_FALSE(file->rate.has_value());
  EXPECT_EQ(file->curves.curves[0].times, std::vector<double>{0.5});
  EXPECT_EQ(file->curves.curves[1].weights, (std::vector<double>{1, 0}));
  // Times that are uneven, or do not begin at 0, tell no rate.
  EXPECT_FALSE(read("time,smile\n1,0\n2,0\n", "w.csv", kTargets)->rate.has_value());
  EXPECT_EQ(read("time,smile\n0,0\n0.0333333,0\n0.0666667,0\n", "w.csv", kTargets)->rate, 30);
  // Rows of keys by hand are no frames: a film of two frames is hardly ever meant.
  EXPECT_FALSE(read("time,smile\n0,0\n1,1\n", "w.csv", kTargets)->rate.has_value());
  // A rate that is no whole number stays what it is.
  EXPECT_NEAR(*read("time,smile\n0,0\n0.03336667,0\n0.06673333,0\n", "w.csv", kTargets)->rate,
              29.97, 1e-3);
}

TEST(Weights, MistakesInTablesAreFoundWhereTheyAre) {
  struct Case {
    const char *text, *code;
    int line, column;
  };
  for (const Case& one : {
           Case{"time,smlie\n0,0\n", "weights-target", 1, 6},
           Case{"frame,smile\n0,0\n", "weights-structure", 1, 1},
           Case{"time,smile,smile\n0,0,0\n", "weights-structure", 1, 12},
           Case{"time,smile\n0,0\n\n0,1\n", "weights-time", 4, 1},
           Case{"smile,time\n0,0\n1,-1\n", "weights-value", 2, 0},
           Case{"time,smile\n0,0\n,1\n", "weights-value", 3, 1},
           Case{"time,smile\n0,1e300\n", "weights-value", 2, 3},
           Case{"time,smile\n0,x\n", "csv-number", 2, 3},
           Case{"time,smile\n0\n", "csv-ragged", 2, 1},
           Case{"time,\"smile\n0\n", "csv-quote", 1, 6},
       }) {
    const Error error = error_of(one.text);
    EXPECT_EQ(error.code, one.code) << one.text << error.message;
    if (one.column == 0) continue;
    EXPECT_EQ(error.where.line, one.line) << one.text << error.message;
    EXPECT_EQ(error.where.column, one.column) << one.text << error.message;
  }
  EXPECT_EQ(error_of("").code, "csv-empty");
}

TEST(Weights, KeysWithoutARateAreThirtyFramesASecond) {
  MorphSet morphs;
  morphs.names = {"smile"};
  const auto weights = read_weights(
      R"({"schema":"krok.weights/1","curves":[{"target":"smile","keys":[[0,0],[1,3]]}]})", "w",
      morphs);
  ASSERT_TRUE(weights.ok());
  EXPECT_EQ(weights->rate, 30);
  EXPECT_EQ(weights->frame_count(), 31);
  EXPECT_FLOAT_EQ(weights->values[10], 1);
  // Without curves all is 0, for one frame.
  const auto none = read_weights(R"({"schema":"krok.weights/1","curves":[]})", "w", morphs);
  ASSERT_TRUE(none.ok());
  EXPECT_EQ(none->values, std::vector<float>{0});
}

}  // namespace
}  // namespace krok::weights
