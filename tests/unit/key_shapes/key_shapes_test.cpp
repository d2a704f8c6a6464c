// If these fail, a key-frame mesh takes other shapes at other times than its file says, a file
// leads out of its folder, or a mistake in it is reported at the wrong place.

#include "formats/key_shapes/key_shapes.h"

#include <gtest/gtest.h>

#include "support/told_mistakes.h"

namespace krok::key_shapes {
namespace {

constexpr const char* kGood = R"({
  "schema": "krok.key-shapes/1",
  "rate": 20,
  "between": "hermite",
  "tension": 0.25,
  "keys": [
    {"time": 0, "shape": "a.obj"},
    {"time": "500ms", "shape": "below/b.glb"},
    {"time": "50f", "shape": "a.obj", "comment": 1}
  ]
})";

TEST(KeyShapes, ReadsWhatTheSpecSays) {
  const auto file = read(kGood);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->times, (std::vector<double>{0, 0.5, 2.5}));
  EXPECT_EQ(file->shapes, (std::vector<std::string>{"a.obj", "below/b.glb", "a.obj"}));
  EXPECT_EQ(file->join, ShapeJoin::hermite);
  EXPECT_EQ(file->tension, 0.25);
  EXPECT_EQ(file->rate, 20);
  const auto least = read(R"({"schema":"krok.key-shapes/1","keys":[{"time":3,"shape":"x.obj"}]})");
  ASSERT_TRUE(least.ok()) << least.error().message;
  EXPECT_EQ(least->join, ShapeJoin::linear);
  EXPECT_EQ(least->tension, 0);
  EXPECT_FALSE(least->rate.has_value());
}

TEST(KeyShapes, MistakesAreFoundWhereTheyAre) {
  const test::Mistake mistakes[] = {
      {"shapes/1", "shapes/9", "key-shapes-structure 2:13"},
      {"\"between\"", "\"betwen\"", "key-shapes-structure 4:3"},
      {"\"hermite\"", "\"cubic\"", "key-shapes-value 4:14"},
      {"0.25", "1.5", "key-shapes-value 5:14"},
      {"\"time\": 0, ", "", "key-shapes-structure 7:5"},
      {"\"500ms\"", "0", "key-shapes-time 8:14"},
      {"\"500ms\"", "-1", "key-shapes-value 8:14"},
      {"\"below/b.glb\"", "\"../b.glb\"", "key-shapes-path 8:32"},
      {"\"below/b.glb\"", "\"/b.glb\"", "key-shapes-path 8:32"},
      {"\"below/b.glb\"", "7", "key-shapes-value 8:32"},
      {"  \"rate\": 20,\n", "", "key-shapes-value 8:14"},
  };
  test::expect_told(kGood, mistakes, [](const std::string& text) { return read(text); });
  EXPECT_EQ(read(R"({"schema":"krok.key-shapes/1","keys":[]})").error().code, "key-shapes-value");
}

}  // namespace
}  // namespace krok::key_shapes
