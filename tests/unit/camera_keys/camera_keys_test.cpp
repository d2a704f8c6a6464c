// If these fail, a camera's keys are taken for others than the file says, or a mistake in the file
// is passed over, reported at the wrong place, or fatal.

#include "formats/camera_keys/camera_keys.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/told_mistakes.h"

namespace krok::camera_keys {
namespace {

constexpr const char* kGood = R"({
  "schema": "krok.camera-keys/1",
  "rate": 50,
  "length_unit": "cm",
  "tension": 0.25,
  "keys": [
    {"time": 0, "position": [0, 160, 400], "target": [0, 100, 0], "field_of_view": 40},
    {"time": "500ms", "position": [10, 0, 0], "orientation": [0, 0.7071, 0, 0.7071], "roll": 90},
    {"time": "100f", "position": [1, 2, 3], "target": [0, 0, 0], "focal_length": 50,
     "between": "ease", "tension": 1, "comment": "any"}
  ]
})";

std::string changed(const std::string& from, const std::string& to) {
  return test::replaced(kGood, from, to);
}

TEST(CameraKeys, ReadsWhatTheSpecSays) {
  const auto file = read(kGood);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->rate, 50);
  EXPECT_FALSE(file->camera.closed);
  const auto& keys = file->camera.keys;
  ASSERT_EQ(keys.size(), 3u);
  EXPECT_LT((keys[0].position - Vec3(0, 1.6, 4)).norm(), 1e-12);
  EXPECT_LT((*keys[0].target - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_NEAR(*keys[0].field_of_view, 40 * kRadiansPerDegree, 1e-12);
  EXPECT_EQ(keys[0].between, Between::smooth);
  EXPECT_EQ(keys[0].tension, 0.25);
  EXPECT_EQ(keys[1].time, 0.5);
  EXPECT_FALSE(keys[1].target.has_value());
  EXPECT_NEAR(keys[1].orientation->norm(), 1, 1e-12);
  EXPECT_NEAR(keys[1].orientation->y(), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(keys[1].roll, kPi / 2, 1e-12);
  EXPECT_FALSE(keys[1].field_of_view.has_value());
  EXPECT_EQ(keys[2].time, 2);
  // A 50 mm lens before 24 mm: published as 26.99 degrees.
  EXPECT_NEAR(*keys[2].field_of_view / kRadiansPerDegree, 26.99, 0.005);
  EXPECT_EQ(keys[2].between, Between::ease);
  EXPECT_EQ(keys[2].tension, 1);
  EXPECT_TRUE(make_track(file->camera, file->rate).ok());
}

TEST(CameraKeys, UnitsAreThoseNamed) {
  const auto feet = read(changed("\"cm\"", "\"ft\""));
  ASSERT_TRUE(feet.ok());
  EXPECT_NEAR(feet->camera.keys[2].position.x(), 0.3048, 1e-12);
  const auto radians = read(
      changed("\"rate\": 50", "\"rate\": 50, \"angle_unit\": \"rad\"")
          .replace(changed("\"rate\": 50", "\"rate\": 50, \"angle_unit\": \"rad\"").find(": 40}"),
                   5, ": 1.5}"));
  ASSERT_TRUE(radians.ok()) << radians.error().message;
  EXPECT_EQ(*radians->camera.keys[0].field_of_view, 1.5);
  EXPECT_EQ(radians->camera.keys[1].roll, 90);
}

TEST(CameraKeys, EveryMistakeIsToldWithItsPlace) {
  const test::Mistake mistakes[] = {
      {"keys/1", "keys/9", "camera-keys-structure 2:13", "krok.camera-keys/9"},
      {"\"rate\": 50", "\"rate\": 0", "camera-keys-value 3:11", "rate"},
      {"\"rate\": 50,", "", "camera-keys-value 9:14", "no \"rate\""},
      {"\"rate\"", "\"fps\"", "camera-keys-structure 3:3", "fps"},
      {"\"cm\"", "\"mile\"", "camera-keys-value 4:18", "mile"},
      {"\"cm\"", "\"5cm\"", "camera-keys-value 4:18", "5cm"},
      {"\"cm\"", "\"cm\", \"angle_unit\": \"turn\"", "camera-keys-value 4:38", "turn"},
      {"\"tension\": 0.25", "\"tension\": 2", "camera-keys-value 5:14", "tension"},
      {"\"time\": 0,", "\"time\": -1,", "camera-keys-value 7:14", "time"},
      {"\"time\": 0,", "\"time\": 1,", "camera-keys-time 8:14", "not after"},
      {"\"time\": 0,", "\"time\": \"soon\",", "camera-keys-value 7:14", "soon"},
      {"\"time\": 0,", "\"time\": \"1e99s\",", "camera-keys-value 7:14", "1e+99"},
      {"\"time\": 0, ", "", "camera-keys-structure 7:5", "time"},
      {"[0, 160, 400]", "[0, 160]", "camera-keys-value 7:29", "3 numbers"},
      {"[0, 160, 400]", "[0, 160, \"4\"]", "camera-keys-value 7:29", "3 numbers"},
      {"[0, 160, 400]", "[0, 160, 1e300]", "camera-keys-value 7:29", "1000 km"},
      {"[0, 160, 400]", "[0, 100, 0]", "camera-keys-value 7:52", "at the camera's position"},
      {", \"target\": [0, 100, 0]", "", "camera-keys-structure 7:5", "one of"},
      {"\"roll\": 90", "\"target\": [1, 1, 1]", "camera-keys-structure 8:5", "one of"},
      {"0.7071]", "0.9]", "camera-keys-value 8:62", "length"},
      {"[0, 0.7071, 0, 0.7071]", "[0, 0, 0, 0]", "camera-keys-value 8:62", "length"},
      {"\"roll\": 90", "\"roll\": 1e9", "camera-keys-value 8:94", "roll"},
      {"\"field_of_view\": 40", "\"field_of_view\": 180", "camera-keys-value 7:84", "view"},
      {"\"field_of_view\": 40", "\"field_of_view\": 40, \"focal_length\": 35",
       "camera-keys-structure 7:5", "both"},
      {"\"focal_length\": 50", "\"focal_length\": 0", "camera-keys-value 9:82", "focal"},
      {"\"ease\"", "\"slow\"", "camera-keys-value 10:17", "slow"},
      {"\"comment\"", "\"coment\"", "camera-keys-structure 10:39", "coment"},
      {"\"cm\"", "\"cm\", \"closed\": true", "camera-keys-value 9:5", "of the first"},
      {"\"tension\": 0.25", "\"closed\": true, \"between\": \"linear\"", "camera-keys-value 7:5",
       "smooth"},
      {"\"schema\"", "schema", "json-syntax 2:3", ""},
  };
  test::expect_told(kGood, mistakes, [](const std::string& text) { return read(text); });
  EXPECT_EQ(read(R"({"schema": "krok.camera-keys/1", "keys": []})").error().code,
            "camera-keys-value");
  EXPECT_EQ(read("[]").error().code, "camera-keys-structure");
  EXPECT_EQ(read("").error().code, "json-syntax");
}

TEST(CameraKeys, AClosedMovementIsRead) {
  const auto file = read(R"({"schema": "krok.camera-keys/1", "closed": true, "keys": [
    {"time": 0, "position": [0, 1, 4], "target": [0, 1, 0]},
    {"time": 1, "position": [4, 1, 0], "target": [0, 1, 0]},
    {"time": 2, "position": [0, 1, 4], "target": [0, 1, 0]}]})");
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_TRUE(file->camera.closed);
  EXPECT_EQ(file->rate, 30);
}

TEST(CameraKeys, DamagedFilesNeverDoHarm) {
  const std::string good = kGood;
  std::mt19937 random(7);
  int read_well = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text = good;
    const unsigned changes = 1 + random() % 4;
    for (unsigned i = 0; i < changes && !text.empty(); ++i) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, 1 + random() % 8);
          break;
        case 2:
          text.insert(at, good.substr(random() % good.size(), random() % 12));
          break;
        default:
          text.resize(at);
      }
    }
    const auto file = read(text);
    if (!file) {
      EXPECT_FALSE(file.error().code.empty());
      EXPECT_GT(file.error().where.line, 0) << text;
      continue;
    }
    ++read_well;
    // What was read is a camera, or too long for one.
    const auto track = make_track(file->camera, 1);
    if (track) {
      EXPECT_TRUE(check(*track).ok());
    }
  }
  EXPECT_GT(read_well, 50);
}

}  // namespace
}  // namespace krok::camera_keys
