// If these fail, captures are read with wrong numbers, or files change when written and read again.
#include "core/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace krok {
namespace {

TEST(ParseFinite, TakesDecimalAndExponentForm) {
  EXPECT_EQ(parse_finite("0"), 0.0);
  EXPECT_EQ(parse_finite("-12.5"), -12.5);
  EXPECT_EQ(parse_finite("+3"), 3.0);
  EXPECT_EQ(parse_finite(".5"), 0.5);
  EXPECT_EQ(parse_finite("5."), 5.0);
  EXPECT_EQ(parse_finite("1e-3"), 1e-3);
  EXPECT_EQ(parse_finite("2.5E+2"), 250.0);
  EXPECT_EQ(parse_finite("0.033333"), 0.033333);
}

TEST(ParseFinite, RefusesWhatIsNotAWholeNumberText) {
  for (const char* text :
       {"",    " ",    "12.3abc",  "1 ",    " 1",     "1,5",   "nan",  "NaN", "-nan",
        "inf", "-Inf", "infinity", "1e",    "1e+",    "--1",   "+-1",  "++1", "+",
        "-",   ".",    "0x10",     "1e999", "-1e999", "1.2.3", "1_000"}) {
    EXPECT_FALSE(parse_finite(text).has_value()) << "'" << text << "'";
  }
  EXPECT_FALSE(parse_finite(std::string_view("1\0", 2)).has_value());
}

TEST(ParseInteger, TakesWholeNumbersOnly) {
  EXPECT_EQ(parse_integer("120"), 120);
  EXPECT_EQ(parse_integer("-7"), -7);
  EXPECT_EQ(parse_integer("+7"), 7);
  EXPECT_EQ(parse_integer("9223372036854775807"), std::numeric_limits<long long>::max());
  for (const char* text : {"", "1.0", "12abc", " 1", "9223372036854775808", "+-1", "0x1", "1e3"}) {
    EXPECT_FALSE(parse_integer(text).has_value()) << "'" << text << "'";
  }
}

TEST(Shortest, ReadsBackTheSame) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value) || std::fpclassify(value) == FP_SUBNORMAL) continue;
    EXPECT_EQ(parse_finite(shortest(value)), value) << shortest(value);
    const auto narrow = static_cast<float>(std::ldexp(
        1.0 + static_cast<double>(bits % 8388608) / 8388608, static_cast<int>(bits >> 40) % 100));
    const auto back = parse_finite(shortest(narrow));
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(static_cast<float>(*back), narrow);
  }
}

TEST(Shortest, IsShort) {
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(0.1f), "0.1");
  EXPECT_EQ(shortest(-0.0), "0");
  EXPECT_EQ(shortest(1.0), "1");
}

TEST(Readable, RoundsForPeople) {
  EXPECT_EQ(readable(0), "0");
  EXPECT_EQ(readable(1.0 / 3.0), "0.333333");
  EXPECT_EQ(readable(1.0 / 3.0, 2), "0.33");
  EXPECT_EQ(readable(120), "120");
  EXPECT_EQ(readable(-1.50), "-1.5");
  EXPECT_EQ(readable(1234567.0, 3), "1234567");
  EXPECT_EQ(readable(2e-7, 3), "2e-07");
}

TEST(Counted, SeparatesThousandsAndKnowsOne) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(-1000), "-1,000");
  EXPECT_EQ(grouped(1234567), "1,234,567");
  EXPECT_EQ(counted(1, "frame"), "1 frame");
  EXPECT_EQ(counted(0, "frame"), "0 frames");
  EXPECT_EQ(counted(12400, "vertex", "vertices"), "12,400 vertices");
}

TEST(Readable, SurvivesWhatIsNoNumber) {
  EXPECT_EQ(readable(std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(readable(std::numeric_limits<double>::infinity()), "inf");
}

}  // namespace
}  // namespace krok
