// If these fail, a motion strip tells the wrong story of where and when the figure was.

#include "render/strip.h"

#include <gmock/gmock.h>

#include "unit/render/figures.h"

namespace krok::render {
namespace {

std::vector<Figure> walkers(double step) {
  std::vector<Figure> figures;
  for (int i = 0; i < 5; ++i) {
    Figure figure;
    figure.centre = Vec3(step * i, 0, 0);
    figure.surfaces = {test::box(figure.centre + Vec3(-0.4, 0, -0.2),
                                 figure.centre + Vec3(0.4, 1.7, 0.2), colour(0xD02020))};
    figures.push_back(figure);
  }
  return figures;
}

Strip strip_of(const std::vector<Figure>& figures) {
  Strip strip;
  for (const Figure& figure : figures) strip.moments.push_back({&figure, "t"});
  strip.path = {Vec3(0, 1, 0), Vec3(4, 1, 0)};
  return strip;
}

TEST(Strip, FiguresThatMoveOnStayWhereTheyWere) {
  const auto figures = walkers(1.0);
  const StripCells cells = strip_row(strip_of(figures), Spread::automatic);
  EXPECT_FALSE(cells.spread_by_time);
  const SheetCell& cell = cells.row.cells.at(0);
  ASSERT_EQ(cell.layers.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(cell.layers[i].figure, &figures[i]);
    EXPECT_EQ(cell.marks[i].at, figures[i].centre);
  }
  EXPECT_EQ(cell.path.size(), 2U);
}

TEST(Strip, FiguresOnThePlaceStandSideBySide) {
  const auto figures = walkers(0.0);
  const StripCells cells = strip_row(strip_of(figures), Spread::automatic);
  EXPECT_TRUE(cells.spread_by_time);
  const SheetCell& cell = cells.row.cells.at(0);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_GT(cell.layers[i].figure->centre.x(), cell.layers[i - 1].figure->centre.x() + 0.3);
    EXPECT_NEAR(bounds(*cell.layers[i].figure).high.y(), 1.7, 1e-6) << "heights stay";
  }
  EXPECT_TRUE(cell.path.empty()) << "there is no way to be shown";
}

TEST(Strip, TheLaterTheLessPale) {
  const auto figures = walkers(1.0);
  const StripCells cells = strip_row(strip_of(figures), Spread::place);
  const auto& layers = cells.row.cells.at(0).layers;
  for (std::size_t i = 1; i < layers.size(); ++i) {
    EXPECT_GT(layers[i].opacity, layers[i - 1].opacity);
  }
  EXPECT_EQ(layers.back().opacity, 1.0);

  Sheet sheet;
  sheet.rows = {cells.row};
  const auto picture = make_sheet(sheet, {.row_height = 200, .cell_width = 1000});
  ASSERT_TRUE(picture.ok());
  const auto& camera = picture->cells[0].camera;
  const auto strength = [&](std::size_t i) {
    const Vec2 at = camera.project(figures[i].centre + Vec3(0, 0.7, 0));
    return test::colourfulness(
        picture->image.at(static_cast<int>(at.x()), static_cast<int>(at.y())));
  };
  EXPECT_LT(strength(0) + 30, strength(4));
}

TEST(Strip, OneMomentAndNoneAreStripsToo) {
  const auto figures = walkers(0.0);
  Strip strip = strip_of(figures);
  strip.moments.resize(1);
  const StripCells one = strip_row(strip, Spread::automatic);
  EXPECT_EQ(one.row.cells.at(0).layers.at(0).opacity, 1.0);
  strip.moments.clear();
  EXPECT_TRUE(strip_row(strip, Spread::time).row.cells.at(0).layers.empty());
}

}  // namespace
}  // namespace krok::render
