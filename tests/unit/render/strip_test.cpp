// If these fail, a motion strip tells the wrong story of where and when the figure was.

#include "render/sheet.h"

#include <gmock/gmock.h>

#include "unit/render/actors.h"

namespace krok::render {
namespace {

std::vector<Actor> walkers(double step) {
  std::vector<Actor> actors;
  for (int i = 0; i < 5; ++i) {
    Actor actor;
    actor.centre = Vec3(step * i, 0, 0);
    actor.surfaces = {test::box(actor.centre + Vec3(-0.4, 0, -0.2),
                                actor.centre + Vec3(0.4, 1.7, 0.2), colour(0xD02020))};
    actors.push_back(actor);
  }
  return actors;
}

Strip strip_of(const std::vector<Actor>& actors) {
  Strip strip;
  for (const Actor& actor : actors) strip.moments.push_back({&actor, "t"});
  strip.path = {Vec3(0, 1, 0), Vec3(4, 1, 0)};
  return strip;
}

TEST(Strip, ActorsThatMoveOnStayWhereTheyWere) {
  const auto actors = walkers(1.0);
  const StripCells cells = strip_row(strip_of(actors), Spread::automatic);
  EXPECT_FALSE(cells.spread_by_time);
  const SheetCell& cell = cells.row.cells.at(0);
  ASSERT_EQ(cell.layers.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(cell.layers[i].actor, &actors[i]);
    EXPECT_EQ(cell.marks[i].at, actors[i].centre);
  }
  EXPECT_EQ(cell.path.size(), 2U);
}

TEST(Strip, ActorsOnThePlaceStandSideBySide) {
  const auto actors = walkers(0.0);
  const StripCells cells = strip_row(strip_of(actors), Spread::automatic);
  EXPECT_TRUE(cells.spread_by_time);
  const SheetCell& cell = cells.row.cells.at(0);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_GT(cell.layers[i].actor->centre.x(), cell.layers[i - 1].actor->centre.x() + 0.3);
    EXPECT_NEAR(bounds(*cell.layers[i].actor).high.y(), 1.7, 1e-6) << "heights stay";
  }
  EXPECT_TRUE(cell.path.empty()) << "there is no way to be shown";
}

TEST(Strip, TheLaterTheLessPale) {
  const auto actors = walkers(1.0);
  const StripCells cells = strip_row(strip_of(actors), Spread::place);
  const auto& layers = cells.row.cells.at(0).layers;
  for (std::size_t i = 1; i < layers.size(); ++i) {
    EXPECT_GT(layers[i].opacity, layers[i - 1].opacity);
  }
  EXPECT_EQ(layers.back().opacity, 1.0);

  Sheet sheet;
  sheet.rows = {cells.row};
  const auto image = make_sheet(sheet, {.row_height = 200, .cell_width = 1000});
  ASSERT_TRUE(image.ok());
  const auto& camera = image->cells[0].camera;
  const auto strength = [&](std::size_t i) {
    const Vec2 at = camera.project(actors[i].centre + Vec3(0, 0.7, 0));
    return test::colourfulness(image->image.at(static_cast<int>(at.x()), static_cast<int>(at.y())));
  };
  EXPECT_LT(strength(0) + 30, strength(4));
}

TEST(Strip, OneMomentAndNoneAreStripsToo) {
  const auto actors = walkers(0.0);
  Strip strip = strip_of(actors);
  strip.moments.resize(1);
  const StripCells one = strip_row(strip, Spread::automatic);
  EXPECT_EQ(one.row.cells.at(0).layers.at(0).opacity, 1.0);
  strip.moments.clear();
  EXPECT_TRUE(strip_row(strip, Spread::time).row.cells.at(0).layers.empty());
}

}  // namespace
}  // namespace krok::render
