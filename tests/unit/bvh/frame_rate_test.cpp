// If these fail, a printed frame time becomes a rate like 30.00003, or a wrong one.

#include "formats/bvh/choose_conventions_internal.h"

#include <gtest/gtest.h>

#include "core/numbers.h"
#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

PrintedRate rate_of(const std::string& text) {
  return rate_of_frame_time(text, *parse_finite(text));
}

TEST(FrameRate, PrintedFrameTimesBecomeCommonRates) {
  EXPECT_EQ(rate_of("0.0333333").rate, 30.0);
  EXPECT_EQ(rate_of("0.0333333000").rate, 30.0);
  EXPECT_EQ(rate_of(".03333").rate, 30.0);
  EXPECT_EQ(rate_of("3.33333e-2").rate, 30.0);
  EXPECT_EQ(rate_of("0.033333333333333333").rate, 30.0);
  EXPECT_EQ(rate_of("0.008333").rate, 120.0);
  EXPECT_EQ(rate_of(".0083333").rate, 120.0);
  EXPECT_EQ(rate_of("0.041667").rate, 24.0);
  EXPECT_EQ(rate_of("0.0416666").rate, 24.0);  // cut off, not rounded
  EXPECT_EQ(rate_of("0.016667").rate, 60.0);
  EXPECT_EQ(rate_of("0.004167").rate, 240.0);
  EXPECT_EQ(rate_of("0.01").rate, 100.0);
  EXPECT_EQ(rate_of("0.010000").rate, 100.0);
  EXPECT_EQ(rate_of("0.02").rate, 50.0);
  EXPECT_EQ(rate_of("0.04").rate, 25.0);
}

TEST(FrameRate, TimesThatWereKeptInSinglePrecisionAreCommonRates) {
  EXPECT_EQ(rate_of("0.03333334").rate, 30.0);
  EXPECT_EQ(rate_of("0.0333333351").rate, 30.0);
  EXPECT_EQ(rate_of("0.0416666679084301").rate, 24.0);
  EXPECT_EQ(rate_of("0.008333334").rate, 120.0);
  EXPECT_DOUBLE_EQ(rate_of("0.033366668").rate, 30.0 / 1.001);
  EXPECT_NE(rate_of("0.0333335").rate, 30.0);
  // Only common ones: what Krok itself writes, with all digits, comes back as it was.
  EXPECT_DOUBLE_EQ(rate_of("0.0041870610093").rate, 1 / 0.0041870610093);
}

TEST(FrameRate, NtscRatesAreToldFromWholeOnes) {
  EXPECT_DOUBLE_EQ(rate_of("0.0333667").rate, 30.0 / 1.001);
  EXPECT_DOUBLE_EQ(rate_of("0.04170833").rate, 24.0 / 1.001);
  EXPECT_DOUBLE_EQ(rate_of("0.0166833").rate, 60.0 / 1.001);
}

TEST(FrameRate, AWholeRateIsTakenWhereTheDigitsLeaveBoth) {
  EXPECT_EQ(rate_of("0.0167").rate, 60.0);
  EXPECT_EQ(rate_of("0.017").rate, 60.0);
  EXPECT_EQ(rate_of("0.0417").rate, 24.0);
  EXPECT_NE(rate_of("0.0417").reason.find("23.976"), std::string::npos) << rate_of("0.0417").reason;
  EXPECT_DOUBLE_EQ(rate_of("0.0334").rate, 30.0 / 1.001);
}

TEST(FrameRate, RatesThatNoCaptureIsMadeAtAreUnusual) {
  EXPECT_TRUE(rate_of("30").unusual);
  EXPECT_NE(rate_of("30").reason.find("frames per second"), std::string::npos);
  EXPECT_TRUE(rate_of("120.0").unusual);
  EXPECT_TRUE(rate_of("33.3333").unusual);
  EXPECT_NE(rate_of("33.3333").reason.find("milliseconds"), std::string::npos);
  EXPECT_NE(rate_of("8.33").reason.find("milliseconds"), std::string::npos);
  EXPECT_TRUE(rate_of("1").unusual);
  EXPECT_TRUE(rate_of("0.0005").unusual);
  EXPECT_FALSE(rate_of("0.2").unusual);
  EXPECT_FALSE(rate_of("0.001").unusual);
}

TEST(FrameRate, OtherRatesStay) {
  EXPECT_DOUBLE_EQ(rate_of("0.1").rate, 10.0);
  EXPECT_DOUBLE_EQ(rate_of("0.05").rate, 20.0);
  EXPECT_DOUBLE_EQ(rate_of("0.066667").rate, 15.0);
  EXPECT_DOUBLE_EQ(rate_of("0.005").rate, 200.0);
  EXPECT_DOUBLE_EQ(rate_of("0.0417083750417").rate, 23.976);  // written so by programs that round
  EXPECT_DOUBLE_EQ(rate_of("1").rate, 1.0);
  EXPECT_DOUBLE_EQ(rate_of("0.0345678901").rate, 1 / 0.0345678901);
  EXPECT_FALSE(rate_of("0.0345678901").snapped);
}

TEST(FrameRate, FewDigitsAreDoubtful) {
  EXPECT_EQ(rate_of("0.033").rate, 30.0);
  EXPECT_TRUE(rate_of("0.033").few_digits);
  EXPECT_EQ(rate_of("0.004").rate, 250.0);
  EXPECT_TRUE(rate_of("0.004").few_digits);
  EXPECT_FALSE(rate_of("0.0333").few_digits);
}

// Of two rates that print alike neither is certain.
TEST(FrameRate, DigitsOfTwoRatesAreLikely) {
  const std::string row = "0 0 0 0 0 0 0 0 0\n";
  for (const auto& [time, confidence] : {std::pair("0.033", Confidence::guess),
                                         {"0.0333", Confidence::likely},
                                         {"0.0083", Confidence::likely},
                                         {"0.033333", Confidence::certain},
                                         {"0.0333667", Confidence::certain}}) {
    EXPECT_EQ(read_ok(kArm + motion(1, row, time)).rate.confidence, confidence) << time;
  }
}

TEST(FrameRate, StrictRefusesARateOfNoCapture) {
  const std::string row = "0 0 0 0 0 0 0 0 0\n";
  EXPECT_EQ(read_error(kArm + motion(1, row, "30"), with(Strictness::strict)).code, "bvh-rate");
  EXPECT_LT(read_ok(kArm + motion(1, row, "30")).clip.rate, 0.05);
}

TEST(FrameRate, AGivenRateStandsAboveTheFile) {
  ReadOptions options = plain_options();
  options.rate = 60;
  const std::string row = "0 0 0 0 0 0 0 0 0\n";
  EXPECT_EQ(read_ok(kArm + motion(1, row), options).clip.rate, 60.0);
  // Also where the file has none that can be used.
  EXPECT_EQ(read_ok(kArm + motion(1, row, "0"), options).clip.rate, 60.0);
  const Capture without = read_ok(kArm + "MOTION\nFrames: 1\n" + row, options);
  EXPECT_EQ(without.clip.rate, 60.0);
  EXPECT_EQ(without.clip.frame_count(), 1);
  EXPECT_NE(find(without.diagnostics, "bvh-frame-time"), nullptr);
  options.rate = -1;
  EXPECT_FALSE(read(kArm + motion(1, row), "test.bvh", options).ok());
}

}  // namespace
}  // namespace krok::bvh
