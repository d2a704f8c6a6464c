// If these fail, the colours of a field stand for other values than it has, or stand elsewhere.

#include "draw/plot.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "unit/draw/svg_reading.h"

namespace krok::draw {
namespace {

using testing::HasSubstr;
using testing::Not;

Panel field_panel(std::vector<double> values, int columns, int rows) {
  Panel panel;
  panel.title = "weight";
  panel.field = Field{2, 6, 10, 30, columns, rows, std::move(values)};
  return panel;
}

Result<std::string> drawn(const Panel& panel) {
  Chart chart;
  chart.panels.push_back(panel);
  return to_svg(chart);
}

struct Cell {
  std::string colour;
  double left, top, width, height;
};

// The rectangles of the field, in the text's order, and those of the bar.
struct Drawn {
  std::vector<Cell> cells, bar;
  std::string svg;
};

Drawn read(const Panel& panel) {
  Drawn result;
  const auto svg = drawn(panel);
  EXPECT_TRUE(svg.ok()) << svg.error().message;
  if (!svg) return result;
  result.svg = *svg;
  const std::string mark = "<rect fill=\"#";
  const auto clipped = result.svg.find("<g clip-path");
  for (auto at = result.svg.find(mark); at != std::string::npos;
       at = result.svg.find(mark, at + 1)) {
    const std::string element = result.svg.substr(at, result.svg.find("/>", at) - at);
    const auto numbers = numbers_of(element, "x=\"%\" y=\"%\" width=\"%\" height=\"%\"");
    EXPECT_EQ(numbers.size(), 1u);
    if (numbers.empty()) continue;
    (at > clipped ? result.cells : result.bar)
        .push_back(
            {element.substr(12, 7), numbers[0][0], numbers[0][1], numbers[0][2], numbers[0][3]});
  }
  return result;
}

TEST(PlotField, ACellStandsWhereItsValueIs) {
  const Drawn drawn = read(field_panel({1, 0.5, -0.5, 0}, 2, 2));
  ASSERT_EQ(drawn.cells.size(), 4u);
  const Ruler x = x_ruler(drawn.svg), y = y_ruler(drawn.svg);
  // The first row is the lower one.
  const double expected[4][2] = {{2, 10}, {4, 10}, {2, 20}, {4, 20}};
  for (std::size_t k = 0; k < 4; ++k) {
    const Cell& cell = drawn.cells[k];
    EXPECT_NEAR(x.value_at(cell.left), expected[k][0], 0.01);
    EXPECT_NEAR(x.value_at(cell.left + cell.width), expected[k][0] + 2, 0.01);
    EXPECT_NEAR(y.value_at(cell.top + cell.height), expected[k][1], 0.1);
    EXPECT_NEAR(y.value_at(cell.top), expected[k][1] + 10, 0.1);
  }
  EXPECT_EQ(drawn.cells[3].colour, "#ffffff");
  EXPECT_NE(drawn.cells[0].colour, drawn.cells[1].colour);
}

double red_less_blue(const std::string& colour) {
  return std::stoi(colour.substr(1, 2), nullptr, 16) - std::stoi(colour.substr(5, 2), nullptr, 16);
}

TEST(PlotField, AboveZeroIsBrownBelowIsVioletAndMoreIsDarker) {
  const Drawn drawn = read(field_panel({-1, -0.4, 0, 0.4, 1}, 5, 1));
  ASSERT_EQ(drawn.cells.size(), 5u);
  EXPECT_LT(red_less_blue(drawn.cells[0].colour), 0);
  EXPECT_LT(red_less_blue(drawn.cells[1].colour), 0);
  EXPECT_EQ(drawn.cells[2].colour, "#ffffff");
  EXPECT_GT(red_less_blue(drawn.cells[3].colour), 0);
  EXPECT_GT(red_less_blue(drawn.cells[4].colour), 0);
  const auto green = [&](std::size_t k) {
    return std::stoi(drawn.cells[k].colour.substr(3, 2), nullptr, 16);
  };
  EXPECT_LT(green(0), green(1));
  EXPECT_LT(green(4), green(3));
}

// The bar's colours are those of the field, its ends carry the round values of its outer steps.
TEST(PlotField, TheBarTellsTheColours) {
  const Drawn drawn = read(field_panel({-0.2, 1, 0.13, 0.4}, 4, 1));
  ASSERT_EQ(drawn.bar.size(), 25u);  // steps of 0.05 from -0.2 to 1
  EXPECT_EQ(drawn.bar.front().colour, drawn.cells[0].colour);
  EXPECT_EQ(drawn.bar.back().colour, drawn.cells[1].colour);
  EXPECT_EQ(drawn.bar[4].colour, "#ffffff");
  EXPECT_EQ(drawn.bar[7].colour, drawn.cells[2].colour);
  EXPECT_THAT(drawn.svg, HasSubstr(">\u22120.20</text>"));
  EXPECT_THAT(drawn.svg, HasSubstr(">1.00</text>"));
}

TEST(PlotField, NeighboursOfOneColourAreOneRectangleAndGapsAreLeftOut) {
  const double gap = std::numeric_limits<double>::quiet_NaN();
  const Drawn drawn = read(field_panel({1, 1, 1, gap, 1, 1}, 6, 1));
  ASSERT_EQ(drawn.cells.size(), 2u);
  EXPECT_NEAR(drawn.cells[0].width, 1.5 * drawn.cells[1].width, 0.02);
  EXPECT_THAT(drawn.svg, Not(HasSubstr("nan")));
}

TEST(PlotField, OneValueOrNoneIsNoTrouble) {
  for (const double value : {0.0, 3.0, -1e300, std::nan("")}) {
    const auto svg = drawn(field_panel({value}, 1, 1));
    ASSERT_TRUE(svg.ok());
    EXPECT_THAT(*svg, Not(HasSubstr("nan")));
    EXPECT_THAT(*svg, Not(HasSubstr("inf")));
  }
}

TEST(PlotField, WhatDoesNotFillItsGridIsRefused) {
  Panel backwards = field_panel({1}, 1, 1);
  backwards.field->x_high = backwards.field->x_low;
  Panel endless = field_panel({1}, 1, 1);
  endless.field->y_high = INFINITY;
  for (const Panel& panel : {field_panel({1, 2}, 1, 1), field_panel({}, 0, 0),
                             field_panel(std::vector<double>(1001), 1001, 1), backwards, endless}) {
    const auto svg = drawn(panel);
    ASSERT_FALSE(svg.ok());
    EXPECT_EQ(svg.error().code, "plot-shape");
  }
}

}  // namespace
}  // namespace krok::draw
