// If these fail, an option's length, angle or time is taken in another unit than the user wrote.
#include "core/numbers.h"

#include <gtest/gtest.h>

#include <numbers>

namespace krok {
namespace {

TEST(ParseLength, KnowsItsUnits) {
  EXPECT_DOUBLE_EQ(*parse_length("1.7m"), 1.7);
  EXPECT_DOUBLE_EQ(*parse_length("1.7"), 1.7);
  EXPECT_DOUBLE_EQ(*parse_length("2dm"), 0.2);
  EXPECT_DOUBLE_EQ(*parse_length("5 cm"), 0.05);
  EXPECT_DOUBLE_EQ(*parse_length("0.1mm"), 0.0001);
  EXPECT_DOUBLE_EQ(*parse_length("20um"), 20e-6);
  EXPECT_DOUBLE_EQ(*parse_length("3in"), 0.0762);
  EXPECT_DOUBLE_EQ(*parse_length("1ft"), 0.3048);
  EXPECT_DOUBLE_EQ(*parse_length("1e-3m"), 0.001);
  EXPECT_DOUBLE_EQ(*parse_length("-2cm"), -0.02);
}

TEST(ParseAngle, BareNumbersAreDegrees) {
  EXPECT_DOUBLE_EQ(*parse_angle("180"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(*parse_angle("15deg"), std::numbers::pi / 12);
  EXPECT_DOUBLE_EQ(*parse_angle("0.25rad"), 0.25);
}

TEST(ParseFrequency, IsInHertz) {
  EXPECT_DOUBLE_EQ(*parse_frequency("6Hz"), 6);
  EXPECT_DOUBLE_EQ(*parse_frequency("0.5 Hz"), 0.5);
  EXPECT_DOUBLE_EQ(*parse_frequency("12.5"), 12.5);
  EXPECT_DOUBLE_EQ(*parse_frequency("1e1Hz"), 10);
  EXPECT_DOUBLE_EQ(*parse_frequency("-1"), -1);  // what it may be is for the option to say
  for (const char* text : {"", "Hz", "nan", "infHz", "6Hz "}) {
    const auto parsed = parse_frequency(text);
    ASSERT_FALSE(parsed.ok()) << "'" << text << "'";
    EXPECT_EQ(parsed.error().code, "quantity-number") << text;
  }
  for (const char* text : {"6hz", "6kHz", "6s", "6fps", "6deg"}) {
    const auto parsed = parse_frequency(text);
    ASSERT_FALSE(parsed.ok()) << text;
    EXPECT_EQ(parsed.error().code, "quantity-unit") << text;
    EXPECT_NE(parsed.error().hint.find("Hz"), std::string::npos) << parsed.error().hint;
  }
}

TEST(ParseClipTime, TellsFramesFromSeconds) {
  EXPECT_DOUBLE_EQ(parse_clip_time("1.5s")->seconds(30), 1.5);
  EXPECT_DOUBLE_EQ(parse_clip_time("250ms")->seconds(30), 0.25);
  EXPECT_DOUBLE_EQ(parse_clip_time("2")->seconds(30), 2.0);
  EXPECT_TRUE(parse_clip_time("120f")->in_frames);
  EXPECT_DOUBLE_EQ(parse_clip_time("120f")->seconds(30), 4.0);
  EXPECT_FALSE(parse_clip_time("120")->in_frames);
}

TEST(Quantity, RefusesTheRest) {
  for (const char* text : {"", "m", "nan", "inf", "1.2.3m", "12 3m", "1m ", "1,5m", "cm5"}) {
    const auto parsed = parse_length(text);
    ASSERT_FALSE(parsed.ok()) << "'" << text << "'";
    EXPECT_EQ(parsed.error().code, "quantity-number") << text;
  }
  for (const char* text : {"12.3abc", "1M", "3deg", "3s", "1e"}) {
    const auto parsed = parse_length(text);
    ASSERT_FALSE(parsed.ok()) << text;
    EXPECT_EQ(parsed.error().code, "quantity-unit") << text;
  }
  EXPECT_FALSE(parse_angle("5m").ok());
  EXPECT_FALSE(parse_clip_time("5deg").ok());
}

TEST(Quantity, SaysWhatFits) {
  const auto parsed = parse_angle("5m");
  ASSERT_FALSE(parsed.ok());
  EXPECT_NE(parsed.error().message.find("5m"), std::string::npos);
  EXPECT_NE(parsed.error().hint.find("deg"), std::string::npos);
}

}  // namespace
}  // namespace krok
