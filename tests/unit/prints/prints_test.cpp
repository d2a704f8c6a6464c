// If these fail, a walker sets its feet elsewhere than a file says, or a mistake in a file is not
// found where it is.
#include "formats/prints/prints.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "math/transform.h"
#include "support/told_mistakes.h"
#include "support/written_bytes.h"

namespace krok::prints {
namespace {

using gait::Print;

const std::string kCsv =
    "side,x [m],z [m],heading [deg],height [m],time [s]\n"
    "left,0.1,0,0,,\n"
    "right,-0.1,0.02,-5,0.5,\n"
    "left,0.11,0.65,90,,1.25\n"
    "right,-0.1,1.3,0,0,2\n";

const std::string kJson = R"({
  "schema": "krok.prints/1",
  "prints": [
    {"side": "left", "x": 0.1, "z": 0, "heading": 0},
    {"side": "right", "x": "-10cm", "z": 0.02, "heading": -5, "height": 0.5},
    {"side": "left", "x": 0.11, "z": 0.65, "heading": 90, "time": "1250ms"},
    {"side": "right", "x": -0.1, "z": 1.3, "heading": 0, "height": 0, "time": 2}
  ]
})";

void expect_the_four(const std::vector<Print>& prints) {
  ASSERT_EQ(prints.size(), 4U);
  EXPECT_EQ(prints[0].side, FootSide::left);
  EXPECT_EQ(prints[1].side, FootSide::right);
  EXPECT_DOUBLE_EQ(prints[1].x, -0.1);
  EXPECT_DOUBLE_EQ(prints[1].z, 0.02);
  EXPECT_DOUBLE_EQ(prints[1].heading, -5 * kRadiansPerDegree);
  EXPECT_DOUBLE_EQ(prints[2].heading, kPi / 2);
  EXPECT_FALSE(prints[0].height);
  EXPECT_EQ(prints[1].height, 0.5);
  EXPECT_EQ(prints[3].height, 0);
  EXPECT_FALSE(prints[1].time);
  EXPECT_EQ(prints[2].time, 1.25);
  EXPECT_EQ(prints[3].time, 2);
}

TEST(Prints, BothFormsSayTheSame) {
  for (const std::string& text : {kCsv, kJson}) {
    const auto prints = read(text, "p");
    ASSERT_TRUE(prints) << prints.error().message;
    expect_the_four(*prints);
    const auto csv = test::bytes_of([&](OutputFile& file) { return write_csv(*prints, file); });
    const auto json = test::bytes_of([&](OutputFile& file) { return write_json(*prints, file); });
    EXPECT_EQ(csv, kCsv);
    expect_the_four(*read(json, "p"));
  }
}

// Would fail if units in headers were ignored, or columns had to be in one order.
TEST(Prints, ColumnsHaveUnitsAndAnyOrder) {
  const auto prints =
      read("time_ms;heading (rad);z_cm;x [mm];Side\n10;1;50;200;R\n20;2;60;300;l\n", "p");
  ASSERT_TRUE(prints) << prints.error().message;
  EXPECT_EQ((*prints)[0].side, FootSide::right);
  EXPECT_DOUBLE_EQ((*prints)[0].x, 0.2);
  EXPECT_DOUBLE_EQ((*prints)[0].z, 0.5);
  EXPECT_DOUBLE_EQ((*prints)[1].heading, 2);
  EXPECT_DOUBLE_EQ(*(*prints)[1].time, 0.02);
}

TEST(Prints, MistakesInCsvAreFound) {
  const test::Mistake mistakes[] = {
      {"side,", "sides,", "prints-column 1:1", "side"},
      {"x [m]", "y [m]", "prints-column 1:6"},
      {",time [s]", ",x", "prints-column 1:43", "second"},
      {"heading [deg]", "heading [m]", "prints-column 1:18", "deg"},
      {"-0.1,0.02", "nan,0.02", "prints-value 3:7", "print 2"},
      {"-0.1,0.02", ",0.02", "prints-value 3:7", "print 2"},
      {"-0.1,0.02", "-0.1,1e9", "prints-value 3:12", "at most"},
      {"-0.1,0.02", "a,0.02", "csv-number 3:7"},
      {"0,,\n", "0,NaN,\n", "prints-value 2:14", "leave the cell empty"},
      {"right,-0.1,0.02", "left,-0.1,0.02", "prints-order 3:1", "alternate"},
      {"right,-0.1,0.02", "both,-0.1,0.02", "prints-value 3:1", "left or right"},
      {"0,0,2\n", "0,0,1.25\n", "prints-order 5:20", "not after print 3 at 1.25 s"},
      {"0,0,2\n", "0,0\n", "csv-ragged 5:1"},
  };
  test::expect_told(
      kCsv, mistakes, [](const std::string& text) { return read(text, "p.csv"); }, "p.csv");
  EXPECT_EQ(read("", "p").error().code, "csv-empty");
  EXPECT_EQ(read("side,x,z,heading\n", "p").error().code, "csv-empty");
  EXPECT_EQ(read("left,0.1,0,0\nright,0.1,0,0\n", "p").error().code, "prints-column");
  const auto missing = read("side,x,heading\nleft,0,0\n", "p");
  EXPECT_EQ(missing.error().message, "there is no column 'z'");
}

TEST(Prints, MistakesInJsonAreFound) {
  const test::Mistake mistakes[] = {
      {"prints/1", "prints/2", "prints-structure 2:13"},
      {"\"heading\": -5", "\"headin\": -5", "prints-structure 5:48", "heading"},
      {", \"heading\": -5", "", "prints-structure 5:5", "heading"},
      {"\"-10cm\"", "\"-10kg\"", "prints-value 5:28"},
      {"\"1250ms\"", "\"12f\"", "prints-value 6:67"},
      {"\"right\"", "\"both\"", "prints-value 5:14", "left or right"},
      {"\"right\"", "\"left\"", "prints-order 5:14", "alternate"},
      {"\"time\": 2", "\"time\": 1", "prints-order 7:79", "not after"},
      {"0.02", "null", "prints-value 5:42"},
  };
  test::expect_told(
      kJson, mistakes, [](const std::string& text) { return read(text, "p.json"); }, "p.json");
}

// Would fail if a long walk's file took more than a moment: most of it is scanning the text.
TEST(Prints, AMillionLinesAreFast) {
  std::string text = "side,x,z,heading,height,time\n";
  for (int i = 0; i < 1'000'000; ++i) {
    text += (i % 2 == 0 ? "left,0.1," : "right,-0.1,") + std::to_string(0.65 * i) + ",0,," +
            std::to_string(0.5 * i) + "\n";
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto prints = read(text, "p");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  ASSERT_TRUE(prints) << prints.error().message;
  EXPECT_EQ(prints->size(), 1'000'000U);
  EXPECT_NEAR(prints->back().z, 0.65 * 999'999, 1e-6);
  EXPECT_LT(took.count(), 20) << "slower than any machine should be";
  RecordProperty("seconds", std::to_string(took.count()));
}

}  // namespace
}  // namespace krok::prints
