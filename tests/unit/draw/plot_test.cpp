// If these fail, a plot shows other values than those it was given, or is no SVG that browsers and
// papers take.

#include "draw/plot.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace krok::draw {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string svg_of(const Panel& panel) {
  Figure figure;
  figure.panels.push_back(panel);
  auto svg = to_svg(figure);
  EXPECT_TRUE(svg.ok()) << svg.error().message;
  return svg.ok() ? *svg : std::string();
}

// The numbers that stand at each % of `pattern`, for each place in the text that it fits.
std::vector<std::vector<double>> numbers_of(const std::string& text, const std::string& pattern) {
  std::vector<std::vector<double>> found;
  for (std::size_t start = 0; start < text.size(); ++start) {
    std::vector<double> row;
    const char* at = text.c_str() + start;
    bool fits = true;
    for (std::size_t i = 0; i < pattern.size() && fits; ++i) {
      if (pattern[i] != '%') {
        fits = *at == pattern[i];
        if (fits) ++at;
        continue;
      }
      char* end = nullptr;
      fits = std::isdigit(static_cast<unsigned char>(*at)) != 0;
      if (!fits) break;
      row.push_back(std::strtod(at, &end));
      at = end;
    }
    if (fits) found.push_back(row);
  }
  return found;
}

// The corners of the first line.
std::vector<std::vector<double>> line_of(const std::string& svg) {
  std::string path = svg.substr(svg.find("class=\"line\""));
  path.resize(path.find("/>"));
  std::replace(path.begin(), path.end(), 'M', 'L');
  return numbers_of(path, "L% %");
}

// How an axis maps values to pixels, read back from two of its tick labels as a person would.
struct Ruler {
  double value_a, pixel_a, value_b, pixel_b;
  bool logarithmic = false;
  double value_at(double pixel) const {
    const double share = (pixel - pixel_a) / (pixel_b - pixel_a);
    return logarithmic ? value_a * std::pow(value_b / value_a, share)
                       : value_a + share * (value_b - value_a);
  }
};

Ruler x_ruler(const std::string& svg) {
  const auto ticks = numbers_of(svg, "text-anchor=\"middle\" x=\"%\" y=\"%\">%<");
  return {ticks.front()[2], ticks.front()[0], ticks.back()[2], ticks.back()[0]};
}

Ruler y_ruler(const std::string& svg) {
  const auto ticks = numbers_of(svg, "text-anchor=\"end\" x=\"%\" y=\"%\">%<");
  // The text's base line is 0.35 of its size below the value.
  return {ticks.front()[2], ticks.front()[1] - 4.2, ticks.back()[2], ticks.back()[1] - 4.2};
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
  const std::string path = line.substr(0, line.find("/>"));
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

TEST(Plot, TextIsTextAndSafe) {
  Panel panel = line_panel();
  panel.title = "a < b & \"c\"\x01";
  const std::string svg = svg_of(panel);
  EXPECT_THAT(svg, HasSubstr(">a &lt; b &amp; &quot;c&quot; <"));
  EXPECT_THAT(svg, HasSubstr(">time (s)<"));
  EXPECT_THAT(svg, HasSubstr(">knee<"));
}

TEST(Plot, TheSameFigureGivesTheSameBytes) {
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

TEST(Plot, RefusesWhatMakesNoPlot) {
  EXPECT_EQ(to_svg(Figure()).error().code, "plot-empty");
  Figure uneven;
  uneven.panels.push_back(line_panel());
  uneven.panels[0].series[0].y.pop_back();
  EXPECT_EQ(to_svg(uneven).error().code, "plot-shape");
  Figure falling;
  falling.panels.push_back(line_panel());
  falling.panels[0].x.low = 2;
  falling.panels[0].x.high = 1;
  EXPECT_EQ(to_svg(falling).error().code, "plot-axis");
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
