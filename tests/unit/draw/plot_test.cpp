// If these fail, a plot shows other values than those it was given, or is no SVG that browsers and
// papers take.

#include "draw/plot.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "unit/draw/svg_reading.h"

namespace krok::draw {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string svg_of(const Panel& panel) {
  Chart chart;
  chart.panels.push_back(panel);
  auto svg = to_svg(chart);
  EXPECT_TRUE(svg.ok()) << svg.error().message;
  return svg.ok() ? *svg : std::string();
}

Panel line_panel() {
  Panel panel;
  panel.x.label = "time";
  panel.x.unit = "s";
  panel.y.label = "angle";
  Series series;
  series.name = "knee";
  series.x = {0, 1, 2, 4};
  series.y = {3, 17.5, 6, 9};
  panel.series.push_back(series);
  return panel;
}

TEST(Plot, APointStandsWhereItsValuesAre) {
  const Panel panel = line_panel();
  const std::string svg = svg_of(panel);
  const Ruler x = x_ruler(svg), y = y_ruler(svg);
  const auto points = line_of(svg);
  ASSERT_GE(points.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(x.value_at(points[i][0]), panel.series[0].x[i], 0.001) << i;
    EXPECT_NEAR(y.value_at(points[i][1]), panel.series[0].y[i], 0.01) << i;
  }
}

TEST(Plot, ALogarithmicAxisPutsDecadesAtEqualSteps) {
  Panel panel;
  panel.x.scale = panel.y.scale = Scale::logarithmic;
  Series series;
  series.style = SeriesStyle::points;
  series.x = {1, 30, 1000, -5, 0};  // the last two cannot be shown
  series.y = {0.001, 0.02, 5, 1, 1};
  panel.series.push_back(series);
  const std::string svg = svg_of(panel);
  Ruler x = x_ruler(svg), y = y_ruler(svg);
  x.logarithmic = y.logarithmic = true;
  const auto points = numbers_of(svg, "cx=\"%\" cy=\"%\"");
  ASSERT_EQ(points.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(x.value_at(points[i][0]) / series.x[i], 1, 0.005) << i;
    EXPECT_NEAR(y.value_at(points[i][1]) / series.y[i], 1, 0.005) << i;
  }
}

TEST(Plot, AThinnedLineStaysWhereItWas) {
  Panel panel;
  Series series;
  for (int i = 0; i < 5000; ++i) {
    series.x.push_back(i / 60.0);
    series.y.push_back(std::sin(i / 300.0));
  }
  panel.series.push_back(series);
  const std::string svg = svg_of(panel);
  const Ruler x = x_ruler(svg), y = y_ruler(svg);
  const auto points = line_of(svg);
  EXPECT_LT(points.size(), 600U);
  EXPECT_GT(points.size(), 50U);
  // Between its corners too: a pixel is 2 / 260 or more of the y axis.
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double middle = (points[i - 1][0] + points[i][0]) / 2;
    const double shown = y.value_at((points[i - 1][1] + points[i][1]) / 2);
    EXPECT_NEAR(shown, std::sin(x.value_at(middle) * 60 / 300.0), 0.002);
  }
}

TEST(Plot, AGapInTheDataIsAGapInTheLine) {
  Panel panel = line_panel();
  panel.series[0].y[2] = std::numeric_limits<double>::quiet_NaN();
  panel.series[0].x.push_back(5);
  panel.series[0].y.push_back(1);
  const std::string svg = svg_of(panel);
  const std::string line = svg.substr(svg.find("class=\"line\""));
  const std::string path = line.substr(0, line.find('>'));
  EXPECT_EQ(std::count(path.begin(), path.end(), 'M'), 2);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(Plot, AUnitIsAsLongOnBothAxesOfAMap) {
  Panel panel = line_panel();
  panel.same_scale = true;
  const std::string svg = svg_of(panel);
  const Ruler x = x_ruler(svg), y = y_ruler(svg);
  const double per_x = (x.pixel_b - x.pixel_a) / (x.value_b - x.value_a);
  const double per_y = (y.pixel_a - y.pixel_b) / (y.value_b - y.value_a);
  EXPECT_NEAR(per_x / per_y, 1, 0.002);
}

// Would fail if a legend showed another colour than the line it names.
TEST(Plot, ALegendIsAsFaintAsItsLine) {
  Panel panel = line_panel();
  const auto faint_marks = [&] {
    const std::string svg = svg_of(panel);
    int count = 0;
    for (auto at = svg.find("opacity=\"0.4\""); at != std::string::npos;
         at = svg.find("opacity=\"0.4\"", at + 1)) {
      ++count;
    }
    return count;
  };
  EXPECT_EQ(faint_marks(), 0);
  panel.series[0].faint = true;
  EXPECT_EQ(faint_marks(), 2) << "the line and its sample";
}

TEST(Plot, TextIsTextAndSafe) {
  Panel panel = line_panel();
  panel.title = "a < b & \"c\"\x01";
  const std::string svg = svg_of(panel);
  EXPECT_THAT(svg, HasSubstr(">a &lt; b &amp; &quot;c&quot;?<"));
  EXPECT_THAT(svg, HasSubstr(">time (s)<"));
  EXPECT_THAT(svg, HasSubstr(">knee<"));
}

TEST(Plot, TheSameChartGivesTheSameBytes) {
  EXPECT_EQ(svg_of(line_panel()), svg_of(line_panel()));
}

TEST(Plot, NothingToShowIsAnEmptyFrame) {
  Panel panel;
  panel.series.emplace_back();
  EXPECT_THAT(svg_of(panel), HasSubstr("</svg>"));
  panel.series[0].x = {std::numeric_limits<double>::infinity()};
  panel.series[0].y = {1};
  EXPECT_THAT(svg_of(panel), Not(HasSubstr("inf")));
}

TEST(Plot, OneValueStandsInTheMiddle) {
  Panel panel;
  Series series;
  series.style = SeriesStyle::points;
  series.x = {7};
  series.y = {0};
  panel.series.push_back(series);
  EXPECT_EQ(numbers_of(svg_of(panel), "cx=\"%\"").size(), 1U);
}

TEST(Plot, OneTickWithinTheValuesMakesNoOddAxis) {
  // Of the multiples of 50 only 50 lies within; the axis is to end at multiples all the same.
  Chart chart;
  chart.panel_height = 100;
  chart.panels = {line_panel()};
  chart.panels[0].series[0].y = {4, 50, 70, 20};
  const auto svg = to_svg(chart);
  ASSERT_TRUE(svg.ok());
  const Ruler y = y_ruler(*svg);
  EXPECT_NEAR(y.value_at(28), 100, 0.01);  // the upper edge of the plotted area
  EXPECT_NEAR(y.value_at(128), 0, 0.01);
}

TEST(Plot, LinesCanBeToldApartWithoutColour) {
  Panel panel;
  for (int i = 0; i < 6; ++i) {
    Series series;
    series.x = {0, 1};
    series.y = {0, 1.0 * i};
    panel.series.push_back(series);
  }
  const std::string svg = svg_of(panel);
  std::set<std::string> patterns;
  for (int i = 0; i < 6; ++i) {
    const std::string line = line_text(svg, i);
    const auto at = line.find("stroke-dasharray");
    patterns.insert(at == std::string::npos ? "" : line.substr(at, line.find('"', at + 18) - at));
  }
  EXPECT_EQ(patterns.size(), 6U);
}

TEST(Plot, BarsOfLanesStandBelowTheData) {
  Panel panel = line_panel();
  panel.y.low = 3;
  panel.spans = {{1, 2, 0, 0}, {0.5, 4, 1, 4}};
  panel.lanes = {"R", "L"};
  const std::string svg = svg_of(panel);
  const Ruler x = x_ruler(svg);
  const auto bars =
      numbers_of(svg, "fill-opacity=\"0.75\" x=\"%\" y=\"%\" width=\"%\" height=\"%\"");
  ASSERT_EQ(bars.size(), 2U);
  EXPECT_NEAR(x.value_at(bars[0][0]), 1, 0.001);
  EXPECT_NEAR(x.value_at(bars[0][0] + bars[0][2]), 2, 0.001);
  EXPECT_NEAR(x.value_at(bars[1][0]), 0.5, 0.001);
  EXPECT_LE(bars[1][1] + bars[1][3], bars[0][1]);  // the second lane above the first
  for (const auto& point : line_of(svg)) EXPECT_LT(point[1], bars[1][1]);
  EXPECT_THAT(svg, HasSubstr(">L<"));
  EXPECT_THAT(svg, HasSubstr(palette()[4]));
}

TEST(Plot, ALegendOfTheChartStandsForAllPanels) {
  Chart chart;
  chart.panels = {line_panel(), line_panel()};
  for (Panel& panel : chart.panels) panel.legend = false;
  chart.legend = {{"left", 0, 0}, {"right", 4, 1}};
  const auto svg = to_svg(chart);
  ASSERT_TRUE(svg.ok());
  EXPECT_EQ(count_of(*svg, ">left<"), 1);
  EXPECT_EQ(count_of(*svg, ">right<"), 1);
  EXPECT_EQ(count_of(*svg, ">knee<"), 0);
}

TEST(Plot, AnArrowEndsALineInItsDirection) {
  Panel panel = line_panel();
  panel.series[0].x = {0, 10, 20};
  panel.series[0].y = {0, 0, 0};
  panel.series[0].arrow = true;
  const std::string svg = svg_of(panel);
  const auto line = line_of(svg);
  const auto head = numbers_of(svg, "d=\"M% %L% %L% %Z\"");
  ASSERT_EQ(head.size(), 1U);
  EXPECT_EQ(head[0][0], line.back()[0]);  // the tip
  EXPECT_LT(head[0][2], head[0][0]);      // the rest behind it
  EXPECT_NEAR(head[0][3] + head[0][5], 2 * head[0][1], 0.01);
  panel.series[0].x = {7};  // nothing that has a direction
  panel.series[0].y = {7};
  EXPECT_EQ(numbers_of(svg_of(panel), "d=\"M% %L% %L% %Z\"").size(), 0U);
}

TEST(Plot, ValuesAtTheEndsOfDoublesDoNoHarm) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  const double huge = std::numeric_limits<double>::max();
  const std::vector<std::vector<double>> rows = {
      {-huge, huge}, {0, tiny}, {1, 1 + 1e-15}, {1e15, 1e15 + 0.125}, {-1e200, 1e200}};
  for (const Scale scale : {Scale::linear, Scale::logarithmic}) {
    for (const auto& row : rows) {
      Panel panel;
      panel.x.scale = panel.y.scale = scale;
      Series series;
      series.x = series.y = row;
      panel.series.push_back(series);
      const std::string svg = svg_of(panel);
      EXPECT_THAT(svg, Not(HasSubstr("nan"))) << row[0] << " " << row[1];
      EXPECT_THAT(svg, Not(HasSubstr("inf"))) << row[0] << " " << row[1];
      EXPECT_LT(svg.size(), 20000U) << row[0] << " " << row[1];
    }
  }
}

TEST(Plot, WhatLiesFarOutsideOfGivenLimitsIsNotDrawnFarAway) {
  Panel panel = line_panel();
  panel.y.low = 0;
  panel.y.high = 1e-6;
  for (const auto& point : line_of(svg_of(panel))) EXPECT_LT(std::abs(point[1]), 1e7);
}

TEST(Plot, AMillionNoisyPointsMakeAFileThatBrowsersOpen) {
  Panel panel;
  Series series;
  std::uint32_t state = 1;
  for (int i = 0; i < 1'000'000; ++i) {
    state = state * 1664525U + 1013904223U;
    series.x.push_back(i);
    series.y.push_back(state / 4294967296.0);
  }
  panel.series.push_back(series);
  const std::string line = svg_of(panel);
  EXPECT_LT(line.size(), 3'000'000U);
  // Nothing of what can be seen is lost: the peaks are there.
  const Ruler y = y_ruler(line);
  double low = 1, high = 0;
  for (const auto& point : line_of(line)) {
    low = std::min(low, y.value_at(point[1]));
    high = std::max(high, y.value_at(point[1]));
  }
  EXPECT_NEAR(low, 0, 1e-3);
  EXPECT_NEAR(high, 1, 1e-3);
  panel.series[0].style = SeriesStyle::points;
  for (double& x : panel.series[0].x) x = std::fmod(x, 100);
  EXPECT_LT(svg_of(panel).size(), 12'000'000U);
}

TEST(Plot, TextThatIsNoUtf8OrTooLongIsMended) {
  Panel panel = line_panel();
  panel.title = "caf\xE9 " + std::string(400, 'x') + " end";
  panel.series[0].name = "\xEF\xBF\xBE" + std::string(5000, 'n');
  const std::string svg = svg_of(panel);
  EXPECT_THAT(svg, HasSubstr("caf\xC3\xA9 "));
  EXPECT_THAT(svg, HasSubstr("xx end<"));
  EXPECT_THAT(svg, HasSubstr("\u2026"));
  EXPECT_THAT(svg, Not(HasSubstr("\xEF\xBF\xBE")));
  EXPECT_LT(svg.size(), 20000U);
}

TEST(Plot, AnAxisOfLargeNumbersTellsItsTicksApart) {
  Panel panel = line_panel();
  panel.series[0].y = {2'000'000, 2'000'004, 2'000'008, 2'000'001};
  EXPECT_THAT(svg_of(panel), HasSubstr(">2000004<"));
}

TEST(Plot, NamesOfMomentsDoNotCoverEachOther) {
  Panel panel = line_panel();
  panel.moments = {{1.0, "first"},
                   {1.001, "second"},
                   {3.0, "third"},
                   {std::numeric_limits<double>::quiet_NaN(), "never"}};
  const std::string svg = svg_of(panel);
  EXPECT_THAT(svg, HasSubstr(">first<"));
  EXPECT_THAT(svg, Not(HasSubstr(">second<")));
  EXPECT_THAT(svg, HasSubstr(">third<"));
  EXPECT_THAT(svg, Not(HasSubstr("never")));
}

TEST(Plot, RefusesWhatMakesNoPlot) {
  EXPECT_EQ(to_svg(Chart()).error().code, "plot-empty");
  Chart uneven;
  uneven.panels.push_back(line_panel());
  uneven.panels[0].series[0].y.pop_back();
  EXPECT_EQ(to_svg(uneven).error().code, "plot-shape");
  Chart falling;
  falling.panels.push_back(line_panel());
  falling.panels[0].x.low = 2;
  falling.panels[0].x.high = 1;
  EXPECT_EQ(to_svg(falling).error().code, "plot-axis");
  Chart flat;
  flat.panels.push_back(line_panel());
  flat.panel_height = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(to_svg(flat).error().code, "plot-size");
}

TEST(Ticks, AreRoundNumbers) {
  EXPECT_THAT(ticks(0, 10, 5, Scale::linear), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(ticks(-0.3, 0.31, 6, Scale::linear),
              ElementsAre(testing::DoubleNear(-0.2, 1e-12), 0, testing::DoubleNear(0.2, 1e-12)));
  EXPECT_THAT(ticks(1, 1000, 5, Scale::logarithmic), ElementsAre(1, 10, 100, 1000));
  EXPECT_THAT(ticks(1, 20, 5, Scale::logarithmic), ElementsAre(1, 2, 5, 10, 20));
  EXPECT_LE(ticks(1e-9, 1e9, 5, Scale::logarithmic).size(), 6U);
}

}  // namespace
}  // namespace krok::draw
