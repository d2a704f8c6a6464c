// If these fail, expressions cross-fade otherwise than motions do, or people blink too often, at
// the wrong speed, or otherwise with the same seed.

#include "face/visemes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace krok::face {
namespace {

const std::vector<std::string> kTargets = {"smile", "blink"};

Item still(double smile, double start, double end) {
  Item item = item_of({kTargets, {{{0.0}, {smile}, {}}, {}}});
  item.start = start;
  item.end = end;
  return item;
}

TEST(FaceMix, AnItemThatFadesInTakesOverFromTheOneBelow) {
  std::vector<Item> items = {still(0.8, 0, 4), still(0.2, 1, 4)};
  items[1].fade_in = {1.0, {timeline::Curve::linear, timeline::Ease::in_out}};
  const auto mixed = mix(kTargets, items, 10, 41);
  ASSERT_TRUE(mixed.ok());
  const auto smile = [&](int frame) { return mixed->values[static_cast<std::size_t>(frame) * 2]; };
  EXPECT_FLOAT_EQ(smile(5), 0.8f);
  EXPECT_NEAR(smile(15), 0.5, 1e-6);
  EXPECT_FLOAT_EQ(smile(30), 0.2f);
  EXPECT_EQ(mixed->names, kTargets);
  EXPECT_EQ(mixed->frame_count(), 41);
}

TEST(FaceMix, AnItemThatAddsLeavesWhatIsBelowAndOthersAlone) {
  std::vector<Item> items = {still(0.5, 0, 1), still(0.4, 0, 1)};
  items[1].additive = true;
  items[1].weight = blend::WeightCurve::constant(0.5);
  const auto mixed = mix(kTargets, items, 10, 21);
  ASSERT_TRUE(mixed.ok());
  EXPECT_NEAR(mixed->values[0], 0.7, 1e-6);
  EXPECT_EQ(mixed->values[1], 0);       // no keys
  EXPECT_EQ(mixed->values[2 * 20], 0);  // after the end
}

TEST(Blinks, AreAsManyAsAskedForAndTheSameForASeed) {
  for (const double rate : {4.5, 17.0, 26.0}) {
    const BlinkOptions options{.per_minute = rate, .seed = 3};
    const auto times = blink_times(60'000, options);
    EXPECT_NEAR(static_cast<double>(times.size()) / 1000, rate, 0.03 * rate);
    EXPECT_EQ(blink_times(60'000, options), times);
    EXPECT_NE(blink_times(60'000, {.per_minute = rate, .seed = 4}), times);
    EXPECT_TRUE(std::ranges::is_sorted(times));
  }
}

TEST(Blinks, CloseFasterThanTheyOpen) {
  const BlinkOptions options;
  const std::vector<double> times = {1.0};
  EXPECT_EQ(blink_at(0.99, times, options), 0);
  EXPECT_NEAR(blink_at(1.04, times, options), 0.5, 1e-9);
  EXPECT_EQ(blink_at(1.1, times, options), 1);
  EXPECT_NEAR(blink_at(1.19, times, options), 0.5, 1e-9);
  EXPECT_EQ(blink_at(1.3, times, options), 0);
}

}  // namespace
}  // namespace krok::face
