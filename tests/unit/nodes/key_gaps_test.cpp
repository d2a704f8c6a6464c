// If these fail, comparing animations overlooks what they do between their keys, or takes
// needlessly long.

#include "nodes/scene_of.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/transform.h"

namespace krok::nodes {
namespace {

Channel channel(Path path, Interpolation interpolation, std::vector<float> times,
                std::vector<float> values) {
  Channel result;
  result.path = path;
  result.interpolation = interpolation;
  result.width = path == Path::rotation ? 4 : 3;
  result.times = std::make_shared<const std::vector<float>>(std::move(times));
  result.values = std::make_shared<const std::vector<float>>(std::move(values));
  return result;
}

std::vector<float> turn(double degrees) {
  const double half = 0.5 * degrees * kRadiansPerDegree;
  return {0, static_cast<float>(std::sin(half)), 0, static_cast<float>(std::cos(half))};
}

std::vector<float> turns(std::initializer_list<double> degrees) {
  std::vector<float> values;
  for (const double one : degrees) {
    const auto value = turn(one);
    values.insert(values.end(), value.begin(), value.end());
  }
  return values;
}

const std::vector<double> kTimes = {0, 1, 2};

TEST(KeyGaps, LinesAreStraightUnlessTheyTurnFar) {
  const Channel way =
      channel(Path::translation, Interpolation::linear, {0, 1, 2}, {0, 0, 0, 1, 0, 0, 5, 0, 0});
  EXPECT_TRUE(key_gaps({"", {way}}, kTimes).empty());
  const Channel far =
      channel(Path::rotation, Interpolation::linear, {0, 1, 2}, turns({0, 20, 170}));
  EXPECT_EQ(key_gaps({"", {way, far}}, kTimes), (std::vector<KeyGap>{{1, false}, {4, false}}));
  EXPECT_EQ(interpolation_words({"", {way, far}}), "linear");
}

TEST(KeyGaps, StepsJumpAtTheirEndWhereTheValueChanges) {
  // A key at 0 and 2 s: the jump is at 2, not at the key that another channel has at 1.
  const Channel step = channel(Path::translation, Interpolation::step, {0, 2}, {0, 0, 0, 1, 0, 0});
  EXPECT_EQ(key_gaps({"", {step}}, kTimes), (std::vector<KeyGap>{{1, false}, {1, true}}));
  const Channel rests = channel(Path::translation, Interpolation::step, {0, 2}, {1, 2, 3, 1, 2, 3});
  EXPECT_TRUE(key_gaps({"", {rests}}, kTimes).empty());
  EXPECT_EQ(interpolation_words({"", {rests}}), "no");
  EXPECT_EQ(interpolation_words({"", {step}}), "step");
}

TEST(KeyGaps, SplinesHaveFourPartsOrOneForEach15Degrees) {
  const auto rotation = [](double end, float tangent) {
    std::vector<float> values;
    for (const double degrees : {0.0, end}) {
      const auto value = turn(degrees);
      values.insert(values.end(), {0, tangent, 0, 0});
      values.insert(values.end(), value.begin(), value.end());
      values.insert(values.end(), {0, tangent, 0, 0});
    }
    return channel(Path::rotation, Interpolation::cubic_spline, {0, 1}, values);
  };
  EXPECT_EQ(key_gaps({"", {rotation(30, 0.2F)}}, std::vector<double>{0, 1}),
            (std::vector<KeyGap>{{4, false}}));
  // Wild tangents turn there and back again; equal keys do not hide that.
  const auto wild = key_gaps({"", {rotation(0, 20)}}, std::vector<double>{0, 1});
  ASSERT_EQ(wild.size(), 1u);
  EXPECT_GT(wild[0].parts, 12);
  EXPECT_LE(wild[0].parts, 64);
  EXPECT_TRUE(key_gaps({"", {rotation(0, 0)}}, std::vector<double>{0, 1}).empty());
}

}  // namespace
}  // namespace krok::nodes
