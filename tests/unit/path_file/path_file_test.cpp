// If these fail, a walker goes another way than was drawn, or a mistake in a drawing is not found
// where it is.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "formats/path/path_format.h"
#include "support/told_mistakes.h"

namespace krok::path_file {
namespace {

std::vector<gait::PathPoint> points_of(const std::string& text,
                                       const ReadOptions& options = {1, {}}) {
  const auto points = read(text, "p", options);
  EXPECT_TRUE(points) << (points ? "" : points.error().message);
  return points ? *points : std::vector<gait::PathPoint>();
}

void expect_places(const std::vector<gait::PathPoint>& points, const std::vector<Vec2>& places) {
  ASSERT_EQ(points.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_NEAR(points[i].x, places[i].x(), 1e-12) << i;
    EXPECT_NEAR(points[i].z, places[i].y(), 1e-12) << i;
  }
}

// Would fail if a command were taken for another, relative for absolute, or numbers that touch for
// one number.
TEST(PathData, LinesOfAllKinds) {
  const std::vector<Vec2> places = {{1, 2}, {4, 6}, {4, 6.5}, {10, 6.5}, {10, -3}, {1, 2}};
  expect_places(points_of("M 1 2 L 4 6 4,6.5 H10 V-3 Z"), places);
  expect_places(points_of("m1,2 3 4l0 .5h6v-9.5z"), places);
  expect_places(points_of("M1 2,4 6L4 6.5H1e1V-3L1 2"), places);
  expect_places(points_of("m.5.5-1-1"), {{0.5, 0.5}, {-0.5, -0.5}});
}

// The point of a curve that is nearest to a place, in metres.
double distance_to(const std::vector<gait::PathPoint>& points, double x, double z) {
  double least = 1e9;
  for (const auto& point : points) least = std::min(least, std::hypot(point.x - x, point.z - z));
  return least;
}

// Would fail if a curve took other control points: each pair draws the same curve in two ways, and
// the middle of each is known from its control points.
TEST(PathData, CurvesOfAllKinds) {
  const auto cubic = points_of("M0 0C0 4 4 4 4 0");
  EXPECT_LT(distance_to(cubic, 2, 3), 0.02);
  EXPECT_LT(distance_to(points_of("M1 1c0 4 4 4 4 0"), 3, 4), 0.02);
  const auto smooth = points_of("M0 0C0 4 4 4 4 0S8 -4 8 0");
  EXPECT_LT(distance_to(smooth, 6, -3), 0.02);
  EXPECT_LT(distance_to(points_of("M0 0c0 4 4 4 4 0s4-4 4 0"), 6, -3), 0.02);
  // After something else than a curve the control point is where the curve begins.
  EXPECT_LT(distance_to(points_of("M0 0L0 4S4 8 4 4"), 0.125 * (0 + 3 * 0 + 3 * 4 + 4),
                        0.125 * (4 + 3 * 4 + 3 * 8 + 4)),
            0.02);
  const auto quadratic = points_of("M0 0Q2 4 4 0T8 0");
  EXPECT_LT(distance_to(quadratic, 2, 2), 0.02);
  EXPECT_LT(distance_to(quadratic, 6, -2), 0.02);
  EXPECT_LT(distance_to(points_of("M0 0q2 4 4 0t4 0"), 6, -2), 0.02);
  for (const auto& curve : {cubic, smooth, quadratic}) {
    for (std::size_t i = 1; i < curve.size(); ++i) {
      EXPECT_LT(std::hypot(curve[i].x - curve[i - 1].x, curve[i].z - curve[i - 1].z), 0.05);
    }
  }
}

// Would fail if an arc had another centre, or took the other way round: all points lie on the
// circle, and the flags choose which part of it.
TEST(PathData, ArcsLieOnTheirEllipse) {
  const auto check = [](const std::string& data, const Vec2& centre, const Vec2& through) {
    const auto points = points_of(data);
    for (const auto& point : points) {
      EXPECT_NEAR(std::hypot(point.x - centre.x(), point.z - centre.y()), 5, 1e-9) << data;
    }
    EXPECT_LT(distance_to(points, through.x(), through.y()), 0.02) << data;
    EXPECT_NEAR(points.back().x, 8, 1e-12);
  };
  check("M0 0A5 5 0 0 1 8 0", {4, 3}, {4, -2});
  check("M0 0A5 5 0 1 0 8 0", {4, 3}, {4, 8});
  check("M0 0a5 5 0 108 0", {4, 3}, {4, 8});
  check("M0 0A5 5 0 0 0 8 0", {4, -3}, {4, 2});
  check("M0 0A5 5 0 1 1 8 0", {4, -3}, {4, -8});
  // Radii that are too small grow; a tilted ellipse has its axes tilted.
  EXPECT_LT(distance_to(points_of("M0 0A1 1 0 0 1 8 0"), 4, -4), 0.02);
  EXPECT_LT(distance_to(points_of("M0 -2A4 2 90 0 1 0 6"), 2, 2), 0.02);
  EXPECT_EQ(points_of("M0 0A0 1 0 0 1 8 0").size(), 2U);
}

const std::string kSvg = R"svg(<?xml version="1.0"?>
<!-- <path d="M9 9L8 8"/> -->
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10">
  <defs><path id="hidden" d="M7 7L6 6"/></defs>
  <g transform="translate(100 50) scale(2)">
    <svg:path id='way' style="a:b" transform="rotate(90)" d="M0 0
      L10 0
      L10 20"/>
    <polyline id="line" points="0,0 5,5 10 0"/>
  </g>
  <path id="last" d="M1 1L2 2"/>
</svg>
)svg";

// Would fail if a comment or a definition were walked, or a transform left out or in another order.
TEST(Svg, TakesWhatIsDrawn) {
  expect_places(points_of(kSvg, {1, {}}), {{100, 50}, {100, 70}, {60, 70}});
  expect_places(points_of(kSvg, {0.01, {}}), {{1, 0.5}, {1, 0.7}, {0.6, 0.7}});
  expect_places(points_of(kSvg, {1, "line"}), {{100, 50}, {110, 60}, {120, 50}});
  expect_places(points_of(kSvg, {1, "last"}), {{1, 1}, {2, 2}});
  expect_places(points_of(kSvg, {1, "hidden"}), {{7, 7}, {6, 6}});
  EXPECT_EQ(read(kSvg, "p", {1, "none"}).error().code, "path-svg");
  const std::string matrix =
      "<svg><path transform='matrix(0 1 -1 0 5 6),skewX(45)' d='M1 1L2 1'/></svg>";
  expect_places(points_of(matrix), {{4, 8}, {4, 9}});
}

TEST(Svg, MistakesAreFound) {
  const test::Mistake mistakes[] = {
      {"L10 0\n", "L10 x\n", "path-data 7:11", "2 numbers"},
      {"L10 20\"", "X10 20\"", "path-data 8:7", "no command"},
      {"L10 20\"", "M10 20\"", "path-data 8:7", "second part"},
      {"L10 20\"", "ZL10 20\"", "path-data 8:8", "follows"},
      {"M0 0\n", "L0 0\n", "path-data 6:62", "begin with M"},
      {"scale(2)", "scale(2", "path-data 5:42"},
      {"scale(2)", "zoom(2)", "path-data 5:35", "zoom"},
      {"d=\"M0 0\n", "d=\"M0 0\n\"", "path-svg 6:5", "XML"},
  };
  test::expect_told(
      kSvg, mistakes, [](const std::string& text) { return read(text, "p.svg"); }, "p.svg");
  EXPECT_EQ(read("<svg></svg>", "p").error().code, "path-svg");
  EXPECT_EQ(read("M", "p").error().code, "path-data");
  EXPECT_EQ(read("M1 1A1 1 0 2 0 1 1", "p").error().code, "path-data");
  EXPECT_EQ(read("M1 1L1e999 0", "p").error().code, "path-data");
}

// Would fail if damaged drawings crashed the reader. Run with the sanitizers.
TEST(Svg, AnyByteAnywhereIsHandled) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    std::string text = kSvg + "M0 0C0 4 4 4 4 0S8 -4 8 0Q2 4 4 0T8 0A5 5 0 0 1 8 0";
    text[random() % text.size()] = static_cast<char>(random());
    text[random() % text.size()] = "<>\"'=/(,MLAZz0-. e"[random() % 18];
    if (i % 2 == 0) text.resize(random() % text.size());
    const auto points = read(text, "p");
    if (!points) {
      EXPECT_FALSE(points.error().message.empty());
    }
  }
}

const std::string kCsv = "x [cm],z [m],time [s]\n0,0,0\n50,2,\n100,4,2.5\n";
const std::string kJson = R"({"schema": "krok.path/1", "points": [
  {"x": 0, "z": 0, "time": 0}, {"x": "50cm", "z": 2},
  {"x": 1, "z": 4, "time": "2500ms"}]})";

TEST(PathFile, TablesAndJsonSayTheSame) {
  for (const std::string& text : {kCsv, kJson}) {
    const auto points = points_of(text);
    expect_places(points, {{0, 0}, {0.5, 2}, {1, 4}});
    EXPECT_EQ(points[0].time, 0);
    EXPECT_FALSE(points[1].time);
    EXPECT_EQ(points[2].time, 2.5);
  }
  const test::Mistake in_csv[] = {{"x [cm]", "y [cm]", "path-column 1:1"},
                                  {"x [cm]", "x [kg]", "path-column 1:1"},
                                  {"time [s]", "x", "path-column 1:14", "second"},
                                  {"50,2", ",2", "path-value 3:1", "point 2"},
                                  {"50,2", "50,b", "csv-number 3:4"}};
  test::expect_told(
      kCsv, in_csv, [](const std::string& text) { return read(text, "p"); }, "p");
  const test::Mistake in_json[] = {{"\"50cm\"", "\"50kg\"", "path-value 2:38"},
                                   {"\"z\": 2", "\"y\": 2", "path-structure 2:46"},
                                   {"path/1", "path/2", "path-structure 1:12"},
                                   {", \"z\": 4", "", "path-structure 3:3", "missing"}};
  test::expect_told(
      kJson, in_json, [](const std::string& text) { return read(text, "p"); }, "p");
}

}  // namespace
}  // namespace krok::path_file
