// If these fail, a contact sheet shows figures where they are not, at another size than it says, or
// differently on another run.

#include "render/sheet.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>

#include "unit/render/actors.h"

namespace krok::render {
namespace {

using test::ball;
using test::box;
using test::coloured_pixels;
using test::colourfulness;
using test::sheet_of;

constexpr Colour kRed = colour(0xD02020);
constexpr Colour kGreen = colour(0x20B020);

// Where a camera puts a point, from rotation matrices alone: the world is turned so that the camera
// looks along -Z, and what is left of x and y is the picture.
Vec2 projected(const CellLayout& cell, const Vec3& point) {
  const Camera& camera = cell.camera;
  const Mat3 turn = (Eigen::AngleAxisd(camera.elevation, Vec3::UnitX()) *
                     Eigen::AngleAxisd(-camera.yaw, Vec3::UnitY()))
                        .toRotationMatrix();
  const Vec3 seen = turn * (point - camera.target);
  return camera.place_of_target + camera.pixels_per_metre * Vec2(seen.x(), -seen.y());
}

Colour pixel_at(const SheetImage& image, const Vec2& place) {
  return image.image.at(static_cast<int>(std::floor(place.x())),
                        static_cast<int>(std::floor(place.y())));
}

TEST(Sheet, APointsPixelIsWhereItProjectsFromEverySide) {
  const std::vector<Vec3> points = {
      {0.1, 0.1, 0.3}, {-0.4, 0.9, 0.2}, {0.5, 1.4, -0.4}, {0, 1.8, 0}, {0.3, 0.6, 0.7}};
  Actor actor;
  for (const Vec3& point : points) actor.bones.push_back(ball(point, 0.08, kRed));
  actor.centre = Vec3(0.2, 0, 0.1);
  for (const double yaw : {0.0, 0.7, 0.5 * kPi, kPi, -2.0}) {
    for (const double elevation : {0.0, 0.3, -0.2, 0.5 * kPi}) {
      const auto image = make_sheet(sheet_of(actor, yaw, elevation), {.row_height = 150});
      ASSERT_TRUE(image.ok()) << image.error().message;
      const CellLayout& cell = image->cells.at(0);
      for (const Vec3& point : points) {
        const Vec2 place = projected(cell, point);
        ASSERT_GT(place.x(), cell.left);
        ASSERT_LT(place.x(), cell.right);
        ASSERT_GT(place.y(), cell.top);
        ASSERT_LT(place.y(), cell.bottom);
        EXPECT_GT(colourfulness(pixel_at(*image, place)), 60) << yaw << " " << elevation;
      }
    }
  }
}

// A ball's area is known, wherever it is and however large: nothing is drawn where nothing is, and
// edges are where they belong.
TEST(Sheet, ABallCoversTheAreaOfACircle) {
  for (const double radius : {1e-9, 0.3, 1e6}) {
    Actor actor;
    actor.bones = {ball({0, radius, 0}, radius, kRed)};
    const auto image = make_sheet(sheet_of(actor), {.row_height = 300});
    ASSERT_TRUE(image.ok());
    const double pixels = radius * image->pixels_per_metre;
    EXPECT_NEAR(pixels, 142, 1);
    // Half covered pixels count from half of the colour on.
    const double circle = kPi * pixels * pixels;
    EXPECT_NEAR(coloured_pixels(*image, 60), circle, 0.01 * circle) << radius;
  }
}

TEST(Sheet, ABoxSeenAtAnAngleIsWiderByTheRootOfTwo) {
  Actor actor;
  actor.surfaces = {box({-0.5, 0, -0.5}, {0.5, 1, 0.5}, kRed)};
  const auto straight = make_sheet(sheet_of(actor, 0), {.row_height = 300});
  const auto turned = make_sheet(sheet_of(actor, 0.25 * kPi), {.row_height = 300});
  ASSERT_TRUE(straight.ok() && turned.ok());
  ASSERT_EQ(straight->pixels_per_metre, turned->pixels_per_metre);
  EXPECT_NEAR(coloured_pixels(*turned) / static_cast<double>(coloured_pixels(*straight)),
              std::sqrt(2.0), 0.01);
}

TEST(Sheet, ABarReachesFromEndToEnd) {
  Actor actor;
  actor.bones = {{Vec3f(-0.5F, 0.2F, 0), Vec3f(0.5F, 0.9F, 0), 0.03F, 0.03F, kRed, kGreen}};
  const auto image = make_sheet(sheet_of(actor), {.row_height = 300});
  ASSERT_TRUE(image.ok());
  const CellLayout& cell = image->cells[0];
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const Vec3 point = (1 - share) * Vec3(-0.5, 0.2, 0) + share * Vec3(0.5, 0.9, 0);
    EXPECT_GT(colourfulness(pixel_at(*image, projected(cell, point))), 40) << share;
  }
  const Colour first = pixel_at(*image, projected(cell, {-0.5, 0.2, 0}));
  const Colour last = pixel_at(*image, projected(cell, {0.5, 0.9, 0}));
  EXPECT_GT(first.red, first.green);
  EXPECT_GT(last.green, last.red);
}

TEST(Sheet, TheNearerHidesTheFartherUnlessThatIsAskedFor) {
  Actor near, far;
  near.bones = {ball({0, 0.5, 0.6}, 0.2, kRed)};
  far.bones = {ball({0, 0.5, -0.6}, 0.3, kGreen)};
  Sheet sheet = sheet_of(near);
  sheet.rows[0].cells[0].layers = {{&near}, {&far}};
  const auto middle = [&sheet] {
    const auto image = make_sheet(sheet, {.row_height = 200});
    EXPECT_TRUE(image.ok());
    return pixel_at(*image, projected(image->cells[0], {0, 0.5, 0}));
  };
  EXPECT_GT(middle().red, middle().green);
  sheet.rows[0].yaw = kPi;
  EXPECT_GT(middle().green, middle().red);
  sheet.rows[0].yaw = 0;
  sheet.rows[0].cells[0].layers[0].behind = true;
  EXPECT_GT(middle().green, middle().red);
  sheet.rows[0].cells[0].layers = {{&near, 0.0}, {&far}};
  EXPECT_GT(middle().green, middle().red) << "a figure without opacity is not seen";
}

TEST(Sheet, OneScaleForAllCellsWhereverTheyStand) {
  Actor small, large;
  small.bones = {ball({100, 0.5, 0}, 0.5, kRed)};
  small.centre = {100, 0, 0};
  large.bones = {ball({-3, 1, 5}, 1, kRed)};
  large.centre = {-3, 0, 5};
  Sheet sheet = sheet_of(small);
  SheetCell cell;
  cell.layers = {{&large}};
  cell.centre = large.centre;
  sheet.rows[0].cells.push_back(cell);
  const auto image = make_sheet(sheet, {.row_height = 300});
  ASSERT_TRUE(image.ok());
  ASSERT_EQ(image->cells.size(), 2U);
  EXPECT_EQ(image->cells[0].camera.pixels_per_metre, image->cells[1].camera.pixels_per_metre);
  SheetImage one = *image;
  one.cells.resize(1);
  const double both = coloured_pixels(*image, 60);
  EXPECT_NEAR(both / coloured_pixels(one, 60), 5, 0.1) << "areas of 1 and 4";
}

TEST(Sheet, ARowAtASmallerScaleIsThatMuchSmaller) {
  Actor actor;
  actor.bones = {ball({-3, 1, 5}, 1, kRed)};
  actor.centre = {-3, 0, 5};
  Sheet sheet = sheet_of(actor);
  sheet.rows.push_back(sheet.rows[0]);
  sheet.rows[1].scale = 0.5;
  const auto image = make_sheet(sheet, {.row_height = 300});
  ASSERT_TRUE(image.ok());
  ASSERT_EQ(image->cells.size(), 2U);
  EXPECT_EQ(image->cells[1].camera.pixels_per_metre, image->pixels_per_metre / 2);
  SheetImage first = *image, second = *image;
  first.cells.resize(1);
  second.cells.erase(second.cells.begin());
  EXPECT_NEAR(double(coloured_pixels(first, 60)) / coloured_pixels(second, 60), 4, 0.1);
}

// Motions of a folder side by side: beyond the first row of them a ground at another height, or a
// cell over its neighbour, would mislead.
TEST(Sheet, RowsSideBySideStandOnOneLineAndDoNotOverlap) {
  Actor small, large;
  small.bones = {ball({0, 0.5, 0}, 0.5, kRed)};
  large.bones = {ball({0, 1, 0}, 1, kRed)};
  Sheet sheet;
  sheet.columns = 2;
  for (const Actor* actor : {&small, &large, &large, &small, &small}) {
    SheetRow row = sheet_of(*actor).rows[0];
    row.cells.push_back(row.cells[0]);
    row.title = "a title that is far wider than the two cells below it, and goes on and on and on";
    sheet.rows.push_back(std::move(row));
  }
  const auto image = make_sheet(sheet, {.row_height = 100});
  ASSERT_TRUE(image.ok());
  ASSERT_EQ(image->cells.size(), 10U);
  for (std::size_t a = 0; a < 10; ++a) {
    const CellLayout& cell = image->cells[a];
    EXPECT_EQ(cell.row, static_cast<int>(a / 2));
    EXPECT_LE(cell.right, image->image.width);
    EXPECT_LE(cell.bottom, image->image.height);
    for (std::size_t b = 0; b < a; ++b) {
      const CellLayout& other = image->cells[b];
      EXPECT_TRUE(cell.left >= other.right || cell.top >= other.bottom) << a << " " << b;
      if (a / 4 != b / 4) continue;
      EXPECT_EQ(cell.camera.project(Vec3::Zero()).y(), other.camera.project(Vec3::Zero()).y());
    }
  }
  // The fifth row stands alone in the third line, below the first column.
  EXPECT_EQ(image->cells[8].left, image->cells[0].left);
}

TEST(Sheet, LinesOfEqualHeightAreRoundNumbersApart) {
  for (const double size : {0.003, 0.2, 1.7, 40.0}) {
    Actor actor;
    actor.surfaces = {box({-0.1 * size, 0, -0.1 * size}, {0.1 * size, size, 0.1 * size}, kRed)};
    const auto image = make_sheet(sheet_of(actor), {.row_height = 280});
    ASSERT_TRUE(image.ok());
    const double digits =
        image->height_step / std::pow(10, std::floor(std::log10(image->height_step) + 1e-9));
    EXPECT_TRUE(std::abs(digits - 1) < 1e-6 || std::abs(digits - 2) < 1e-6 ||
                std::abs(digits - 5) < 1e-6)
        << digits;
    EXPECT_GE(image->height_step * image->pixels_per_metre, 40);
    EXPECT_LE(image->height_step * image->pixels_per_metre, 120);
  }
}

TEST(Sheet, TheGroundIsLeftOutOnlyWhereItIsFarAway) {
  Actor actor;
  actor.bones = {ball({0, 50, 0}, 0.5, kRed)};
  const auto high = make_sheet(sheet_of(actor), {.row_height = 280});
  ASSERT_TRUE(high.ok());
  EXPECT_GT(high->pixels_per_metre, 200) << "the figure is not made tiny for the ground's sake";
  actor.bones = {ball({0, 1.2, 0}, 0.5, kRed)};
  const auto near = make_sheet(sheet_of(actor), {.row_height = 280});
  ASSERT_TRUE(near.ok());
  const CellLayout& cell = near->cells[0];
  EXPECT_LT(cell.camera.place_of_target.y(), cell.bottom) << "the ground is in the picture";
}

TEST(Sheet, TheSamePixelsForAnyNumberOfThreads) {
  Actor actor;
  actor.surfaces = {box({-0.3, 0, -0.2}, {0.3, 1.5, 0.2}, kRed)};
  actor.bones = {{Vec3f(0.4F, 1, 0.1F), Vec3f(-0.6F, 1.3F, 0.4F), 0.1F, 0.05F, kGreen, kRed}};
  for (const double elevation : {0.0, 0.6}) {
    const auto once = make_sheet(sheet_of(actor, 0.4, elevation), {.row_height = 200, .jobs = 1});
    ASSERT_TRUE(once.ok());
    for (const int jobs : {2, 5}) {
      const auto again =
          make_sheet(sheet_of(actor, 0.4, elevation), {.row_height = 200, .jobs = jobs});
      ASSERT_TRUE(again.ok());
      EXPECT_EQ(once->image.rgb, again->image.rgb) << jobs;
    }
  }
}

TEST(Sheet, RaisedItShowsAShadowUnderTheActor) {
  Actor actor;
  actor.surfaces = {box({-0.3, 0.05, -0.3}, {0.3, 1, 0.3}, kRed)};
  const auto darkest = [&actor](double elevation) {
    const auto image = make_sheet(sheet_of(actor, 0, elevation), {.row_height = 300});
    EXPECT_TRUE(image.ok());
    const CellLayout& cell = image->cells[0];
    // Just before the box, on the ground and half way to the grid's next line.
    return static_cast<int>(pixel_at(*image, projected(cell, {0.05, 0, 0.34})).red);
  };
  EXPECT_LT(darkest(0.7), 225) << "the panel has 244";
}

// Shadows are computed at few points and interpolated; a step between two blocks would show.
TEST(Sheet, AShadowFadesEvenly) {
  Actor actor;
  actor.bones = {ball({0, 0.3, 0}, 0.3, kRed)};
  Actor far;  // makes the picture wide
  far.bones = {ball({1.2, 0.01, 0}, 0.01, kGreen)};
  Sheet sheet = sheet_of(actor, 0, 0.5 * kPi);
  sheet.rows[0].cells[0].layers.push_back({&far});
  const auto image = make_sheet(sheet, {.row_height = 400, .cell_width = 800});
  ASSERT_TRUE(image.ok());
  const CellLayout& cell = image->cells[0];
  const double step = image->height_step;  // of the grid
  int before = -1, steps = 0;
  for (int x = cell.right - 20; x > cell.left; --x) {
    const double metres = (x + 0.5 - cell.camera.place_of_target.x()) / image->pixels_per_metre;
    if (std::abs(metres - step * std::round(metres / step)) * image->pixels_per_metre < 3) continue;
    const Colour colour = pixel_at(*image, projected(cell, {metres, 0, 0.3 * step}));
    if (colourfulness(colour) > 20) break;  // the ball
    if (before >= 0) {
      EXPECT_LE(colour.red, before + 3) << "darker towards the ball, at " << x;
      EXPECT_GE(colour.red, before - 12) << "in small steps, at " << x;
      steps += colour.red < before ? 1 : 0;
    }
    before = colour.red;
  }
  EXPECT_GT(steps, 10);
  EXPECT_LT(before, 235) << "the panel has 244";
}

// Smooth pixels have one line of sight; outlines keep all samples.
TEST(Sheet, AnOutlineIsBlendedAndASmoothSurfaceIsEven) {
  Actor actor;
  actor.surfaces = {box({-0.5, 0, -0.5}, {0.5, 1, 0.5}, kRed)};
  actor.bones = {{Vec3f(-0.9F, 1.2F, 0), Vec3f(0.9F, 1.9F, 0), 0.02F, 0.02F, kGreen, kGreen}};
  const auto image = make_sheet(sheet_of(actor), {.row_height = 400});
  ASSERT_TRUE(image.ok());
  const CellLayout& cell = image->cells[0];
  std::set<int> shades;
  for (double height = 1.0; height < 2; height += 0.001) {
    shades.insert(pixel_at(*image, projected(cell, {0.6, height, 0})).red);
  }
  EXPECT_GE(shades.size(), 5u) << "of the bar's slanted edge";
  int least = 255, most = 0;
  for (double x = -0.4; x < 0.4; x += 0.01) {
    const int red = pixel_at(*image, projected(cell, {x, 0.5, 0.5})).red;
    least = std::min(least, red);
    most = std::max(most, red);
  }
  EXPECT_LE(most - least, 2) << "nothing is near this face";
}

TEST(Sheet, WhatHasNoSizeIsShownToo) {
  Actor point;
  point.bones = {ball({0, 0, 0}, 0, kRed)};
  Actor nothing;
  Actor no_triangles;
  no_triangles.surfaces = {box({0, 0, 0}, {1, 1, 1}, kRed)};
  no_triangles.surfaces[0].triangles = std::make_shared<Triangles>();
  for (const Actor* actor : {&point, &nothing, &no_triangles}) {
    const auto image = make_sheet(sheet_of(*actor), {.row_height = 100});
    ASSERT_TRUE(image.ok()) << image.error().message;
    EXPECT_EQ(coloured_pixels(*image), 0);
  }
}

std::string code_of(const Sheet& sheet, const SheetOptions& options = {}) {
  const auto image = make_sheet(sheet, options);
  return image ? "" : image.error().code;
}

TEST(Sheet, SaysWhatItCannotDraw) {
  Actor good;
  good.bones = {ball({0, 1, 0}, 0.1, kRed)};
  EXPECT_EQ(code_of({}), "sheet-empty");
  EXPECT_EQ(code_of(sheet_of(good), {.row_height = 5}), "sheet-size");
  EXPECT_EQ(code_of(sheet_of(good), {.row_height = 100000}), "sheet-size");
  EXPECT_EQ(code_of(sheet_of(good), {.cell_width = -1}), "sheet-size");
  Sheet huge = sheet_of(good);
  huge.rows[0].cells.resize(5000, huge.rows[0].cells[0]);
  EXPECT_EQ(code_of(huge), "sheet-size");

  const float nan = std::numeric_limits<float>::quiet_NaN();
  Actor bad = good;
  bad.bones[0].from.x() = nan;
  EXPECT_EQ(code_of(sheet_of(bad)), "render-figure");
  bad = good;
  bad.bones[0].to_radius = -1;
  EXPECT_EQ(code_of(sheet_of(bad)), "render-figure");
  bad = good;
  bad.surfaces = {box({0, 0, 0}, {1, 1, 1}, kRed)};
  EXPECT_EQ(code_of(sheet_of(bad)), "");
  bad.surfaces[0].triangles = std::make_shared<Triangles>(Triangles{{0, 1, 8}});
  EXPECT_EQ(code_of(sheet_of(bad)), "render-figure") << "a vertex that does not exist";
  bad.surfaces = {box({0, 0, 0}, {1, 1, 1}, kRed)};
  bad.surfaces[0].positions[3].y() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(code_of(sheet_of(bad)), "render-figure");
  bad.surfaces = {box({0, 0, 0}, {1, 1, 1}, kRed)};
  bad.surfaces[0].normals.resize(3, Vec3f::UnitY());
  EXPECT_EQ(code_of(sheet_of(bad)), "render-figure");
}

TEST(ColourKey, GoesFromBlueToRedAndIsGreyForTheSame) {
  ColourKey key;
  key.low = 0.1;
  key.high = 10;
  EXPECT_EQ(key.at(0), key.at(0.1));
  EXPECT_LT(colourfulness(key.at(0.05)), 24);
  EXPECT_GT(key.at(0.2).blue, key.at(0.2).red);
  EXPECT_GT(key.at(10).red, key.at(10).blue + 100);
  EXPECT_EQ(key.at(11), key.at(10));
  EXPECT_EQ(key.at(std::numeric_limits<double>::quiet_NaN()), key.at(10));
}

}  // namespace
}  // namespace krok::render
