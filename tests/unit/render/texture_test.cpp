// If these fail, pictures on surfaces are in another place, turned, in another colour or noisy from
// afar, or what they cut out is drawn.

#include "render/texture.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

#include "unit/render/actors.h"

namespace krok::render {
namespace {

using Wrap = krok::Texture::Wrap;
using Rgba = std::array<std::uint8_t, 4>;

constexpr Rgba kRedTexel = {200, 30, 20, 255}, kBlueTexel = {20, 40, 180, 255},
               kClearTexel = {20, 40, 180, 0};

std::shared_ptr<const Mipmap> mipmap(int width, int height,
                                     const std::function<Rgba(int x, int y)>& at) {
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Rgba pixel = at(x, y);
      rgba.insert(rgba.end(), pixel.begin(), pixel.end());
    }
  }
  auto made = Mipmap::create(width, height, std::move(rgba));
  EXPECT_TRUE(made.ok());
  return std::make_shared<const Mipmap>(*std::move(made));
}

// Red to the left, blue to the right; below, the same darker.
std::shared_ptr<const Mipmap> four_fields(int side = 64) {
  return mipmap(side, side, [side](int x, int y) {
    Rgba pixel = x < side / 2 ? kRedTexel : kBlueTexel;
    if (y >= side / 2) {
      for (int c = 0; c < 3; ++c) pixel[static_cast<std::size_t>(c)] /= 2;
    }
    return pixel;
  });
}

Paint paint_of(std::shared_ptr<const Mipmap> image) {
  Paint paint;
  paint.image = std::move(image);
  return paint;
}

// A square of one metre standing on the ground that shows the picture from `low` to `high`.
Surface square(Colour colour) {
  Surface surface;
  surface.positions = {{-0.5F, 0, 0}, {0.5F, 0, 0}, {0.5F, 1, 0}, {-0.5F, 1, 0}};
  surface.triangles = std::make_shared<Triangles>(Triangles{{0, 1, 2}, {0, 2, 3}});
  surface.colours = {colour};
  return surface;
}

Surface square(Paint paint, const Vec2f& low = {0, 0}, const Vec2f& high = {1, 1}) {
  Surface surface = square(colour(0));
  paint.coordinates = std::make_shared<const std::vector<Vec2f>>(
      std::vector<Vec2f>{{low.x(), high.y()}, high, {high.x(), low.y()}, low});
  surface.paint = std::make_shared<const Paint>(std::move(paint));
  return surface;
}

SheetImage shot(const std::vector<Surface>& surfaces, int size = 200, double yaw = 0,
                int jobs = 1) {
  Actor actor;
  actor.surfaces = surfaces;
  auto image = make_sheet(test::sheet_of(actor, yaw), {.row_height = size, .jobs = jobs});
  EXPECT_TRUE(image.ok()) << image.error().message;
  return std::move(*image);
}

Colour seen(const SheetImage& image, double x, double y) {
  const Vec2 place = image.cells.at(0).camera.project(Vec3(x, y, 0));
  return image.image.at(static_cast<int>(place.x()), static_cast<int>(place.y()));
}

Colour colour_of(const Rgba& rgba) {
  return {rgba[0], rgba[1], rgba[2]};
}

void expect_near(Colour a, Colour b, int tolerance, const std::string& what) {
  EXPECT_LE(std::abs(a.red - b.red), tolerance) << what;
  EXPECT_LE(std::abs(a.green - b.green), tolerance) << what;
  EXPECT_LE(std::abs(a.blue - b.blue), tolerance) << what;
}

// Light falls on a painted square as on one that has that colour all over.
void expect_as_plain(const SheetImage& image, double x, double y, Colour plain,
                     const std::string& what, int tolerance = 1) {
  expect_near(seen(image, x, y), seen(shot({square(plain)}), x, y), tolerance, what);
}

TEST(Texture, FieldsOfAImageAreWhereTheCoordinatesPutThem) {
  const SheetImage image = shot({square(paint_of(four_fields()))});
  expect_as_plain(image, -0.25, 0.75, colour_of(kRedTexel), "upper left");
  expect_as_plain(image, 0.25, 0.75, colour_of(kBlueTexel), "upper right");
  expect_as_plain(image, -0.25, 0.25, {100, 15, 10}, "lower left");
  expect_as_plain(image, 0.25, 0.25, {10, 20, 90}, "lower right");
}

// As glTF 2.0, section 3.9.2 has it: vertex colours multiply the texture, in linear light.
TEST(Texture, IsMultipliedByTheColoursOfVertices) {
  Surface surface = square(paint_of(mipmap(1, 1, [](int, int) { return kRedTexel; })));
  const Colour tint = colour(0x80FF40);
  surface.colours.assign(4, tint);
  const Colour product = to_colour(to_light(colour_of(kRedTexel)).cwiseProduct(to_light(tint)));
  expect_as_plain(shot({surface}), 0, 0.5, product, "middle");
  surface.colours.assign(1, tint);
  expect_as_plain(shot({surface}), 0, 0.5, colour_of(kRedTexel), "one colour is replaced");
}

// Three copies from u = -1 to 2, as glTF 2.0, section 5.26 (sampler) has them.
TEST(Texture, BeyondTheImageItRepeatsMirrorsOrEnds) {
  const auto line = [](Wrap wrap) {
    Paint paint = paint_of(four_fields());
    paint.wrap_u = wrap;
    const SheetImage image = shot({square(paint, {-1, 0}, {2, 1})});
    std::string found;
    for (int i = 0; i < 6; ++i) {
      const Colour colour = seen(image, -0.5 + (i + 0.5) / 6, 0.75);
      found += colour.red > colour.blue ? 'r' : 'b';
    }
    return found;
  };
  EXPECT_EQ(line(Wrap::repeat), "rbrbrb");
  EXPECT_EQ(line(Wrap::mirror), "brrbbr");
  EXPECT_EQ(line(Wrap::clamp), "rrrbbb");
}

TEST(Texture, UpAndDownWrapOnTheirOwn) {
  Paint paint = paint_of(four_fields());
  paint.wrap_v = Wrap::clamp;
  const SheetImage image = shot({square(paint, {0, -1}, {1, 2})});
  for (const double y : {0.95, 0.75, 0.6}) {
    expect_as_plain(image, -0.25, y, colour_of(kRedTexel), "the upper half and all above it");
  }
  for (const double y : {0.4, 0.2, 0.05}) {
    expect_as_plain(image, -0.25, y, {100, 15, 10}, "the lower half and all below it");
  }
}

TEST(Texture, FactorsMultiplyLightNotNumbersOfTheScreen) {
  Paint paint = paint_of(mipmap(1, 1, [](int, int) { return Rgba{188, 188, 188, 255}; }));
  paint.factor = {0.5F, 1.0F, 0.25F, 1.0F};
  // 188 is half of the light (0.5029), a quarter is 137, an eighth 99 (IEC 61966-2-1).
  const Vec4f light = paint.at({0.5F, 0.5F}, {0, 0}, {0, 0});
  EXPECT_NEAR(light.x(), 0.25, 0.002);
  EXPECT_NEAR(light.y(), 0.5, 0.004);
  EXPECT_NEAR(light.z(), 0.125, 0.001);
  expect_as_plain(shot({square(paint)}), 0, 0.5, {137, 188, 99}, "a surface");
}

TEST(Texture, FromNearColoursChangeEvenlyOrInSquares) {
  Paint paint = paint_of(mipmap(2, 1, [](int x, int) {
    return x == 0 ? Rgba{0, 0, 0, 255} : Rgba{255, 255, 255, 255};
  }));
  paint.wrap_u = Wrap::clamp;
  const auto light = [&paint](float u) { return paint.at({u, 0.5F}, {0, 0}, {0, 0}).x(); };
  for (const auto& [u, expected] : {std::pair(0.1F, 0.0F),
                                    {0.25F, 0.0F},
                                    {0.375F, 0.25F},
                                    {0.5F, 0.5F},
                                    {0.7F, 0.9F},
                                    {0.75F, 1.0F},
                                    {1.0F, 1.0F}}) {
    EXPECT_NEAR(light(u), expected, 1e-5) << u;
  }
  paint.wrap_u = Wrap::repeat;
  EXPECT_NEAR(light(0.0F), 0.5, 1e-5) << "across the seam";
  EXPECT_NEAR(light(0.9F), 0.7, 1e-5);
  paint.smooth = false;
  EXPECT_EQ(light(0.49F), 0.0F);
  EXPECT_EQ(light(0.51F), 1.0F);
}

TEST(Texture, FromAfarACheckerboardIsEvenlyGrey) {
  const auto board = mipmap(512, 512, [](int x, int y) {
    return (x + y) % 2 == 0 ? Rgba{0, 0, 0, 255} : Rgba{255, 255, 255, 255};
  });
  // Half of the light is 188 on a screen; the mean of the numbers, 128, would be too dark.
  const SheetImage image = shot({square(paint_of(board))}, 100);
  const SheetImage plain = shot({square(colour(0xBCBCBC))}, 100);
  for (double x = -0.4; x < 0.41; x += 0.05) {
    for (double y = 0.1; y < 0.91; y += 0.05) {
      expect_near(seen(image, x, y), seen(plain, x, y), 1, "from the front");
    }
  }
  // Nearly edge on, where a pixel covers much more of the picture across than down.
  const double yaw = 80 * kRadiansPerDegree;
  const SheetImage aside = shot({square(paint_of(board))}, 100, yaw);
  const SheetImage plain_aside = shot({square(colour(0xBCBCBC))}, 100, yaw);
  for (double y = 0.1; y < 0.91; y += 0.05) {
    expect_near(seen(aside, 0, y), seen(plain_aside, 0, y), 1, "from the side");
  }
}

// Stripes across the way in which a surface leans away keep their colours: only the other way is
// averaged.
TEST(Texture, StripesStaySharpOnASurfaceThatLeansAway) {
  const auto stripes =
      mipmap(64, 64, [](int, int y) { return y / 16 % 2 == 0 ? kRedTexel : kBlueTexel; });
  const double yaw = 80 * kRadiansPerDegree;
  const SheetImage image = shot({square(paint_of(stripes))}, 100, yaw);
  const SheetImage red = shot({square(colour_of(kRedTexel))}, 100, yaw);
  expect_near(seen(image, 0, 0.875), seen(red, 0, 0.875), 3, "the upper stripe");
  expect_near(seen(image, 0, 0.375), seen(red, 0, 0.375), 3, "the third stripe");
}

TEST(Texture, SmallerImagesShareOddSidesOutEvenly) {
  // 255, 0, 0: a third of the light each time, whatever the place of the white pixel.
  for (int white = 0; white < 3; ++white) {
    const auto made = mipmap(3, 1, [white](int x, int) {
      return x == white ? Rgba{255, 255, 255, 255} : Rgba{0, 0, 0, 0};
    });
    ASSERT_EQ(made->levels().size(), 2U);
    EXPECT_NEAR(made->levels()[1].rgba[0], 156, 1);  // 1/3 of the light
    EXPECT_EQ(made->levels()[1].rgba[3], 85);
  }
  const auto odd = mipmap(7, 5, [](int, int) { return kBlueTexel; });
  ASSERT_EQ(odd->levels().size(), 3U);
  EXPECT_EQ(odd->levels()[1].width, 3);
  EXPECT_EQ(odd->levels()[1].height, 2);
  for (const Mipmap::Level& level : odd->levels()) {
    EXPECT_EQ(level.rgba.size(), 4U * static_cast<unsigned>(level.width * level.height));
    EXPECT_EQ(level.rgba[2], kBlueTexel[2]);
  }
}

// The right half is clear: what is behind it is seen, another surface or nothing.
TEST(Texture, WhatIsCutOutShowsWhatIsBehind) {
  Paint paint =
      paint_of(mipmap(64, 64, [](int x, int) { return x < 32 ? kRedTexel : kClearTexel; }));
  const auto with_cutoff = [&paint](float cutoff) {
    paint.cutoff = cutoff;
    return square(paint);
  };
  Surface behind = square(colour(0x20B020));
  for (Vec3f& point : behind.positions) point.z() = -0.5F;
  const SheetImage both = shot({with_cutoff(0.5F), behind});
  EXPECT_GT(seen(both, -0.25, 0.5).red, seen(both, -0.25, 0.5).green);
  EXPECT_GT(seen(both, 0.25, 0.5).green, 2 * seen(both, 0.25, 0.5).blue);
  const SheetImage alone = shot({with_cutoff(0.5F)});
  EXPECT_LT(test::colourfulness(seen(alone, 0.25, 0.5)), 10) << "the picture's ground";
  EXPECT_GT(test::colourfulness(seen(alone, -0.25, 0.5)), 60);
  // Without a cutoff alpha does not count.
  expect_as_plain(shot({with_cutoff(0)}), 0.25, 0.5, colour_of(kClearTexel), "the clear half");
}

TEST(Texture, AlphaAtTheCutoffIsDrawnAndTheFactorCounts) {
  Paint paint = paint_of(mipmap(1, 1, [](int, int) { return Rgba{200, 30, 20, 204}; }));  // 0.8
  const auto drawn = [&paint] { return test::coloured_pixels(shot({square(paint)})) > 1000; };
  paint.cutoff = 0.8F;
  EXPECT_TRUE(drawn());
  paint.cutoff = 0.81F;
  EXPECT_FALSE(drawn());
  paint.cutoff = 0.5F;
  paint.factor.w() = 0.6F;  // 0.48
  EXPECT_FALSE(drawn());
  paint.factor.w() = 0.65F;  // 0.52
  EXPECT_TRUE(drawn());
}

// Fine holes stay holes from afar, and as large a share of the whole.
TEST(Texture, HolesKeepTheirShareFromAfar) {
  Paint paint = paint_of(mipmap(256, 256, [](int x, int y) {
    return (x / 2 + y / 2) % 4 == 0 ? Rgba{200, 30, 20, 255} : Rgba{200, 30, 20, 0};
  }));
  paint.smooth = false;
  paint.cutoff = 0.5F;
  const SheetImage image = shot({square(paint)}, 100);
  const SheetImage whole = shot({square(colour_of(kRedTexel))}, 100);
  double holes = 0, all = 0;
  for (double x = -0.4; x < 0.41; x += 0.02) {
    for (double y = 0.1; y < 0.91; y += 0.02) {
      holes += test::colourfulness(seen(image, x, y));
      all += test::colourfulness(seen(whole, x, y));
    }
  }
  EXPECT_GT(holes / all, 0.1);
  EXPECT_LT(holes / all, 0.5);
}

TEST(Texture, AnyNumberOfThreadsPaintsAlike) {
  Paint paint = paint_of(four_fields());
  paint.cutoff = 0.5F;
  const std::vector<Surface> surfaces = {square(paint, {-2, -2}, {3, 3})};
  EXPECT_EQ(shot(surfaces, 150, 0.5, 1).image.rgb, shot(surfaces, 150, 0.5, 4).image.rgb);
}

TEST(Texture, OddCoordinatesAreDrawn) {
  for (const float odd : {1e30F, -1e30F, 3.4e38F, 0.0F}) {
    const SheetImage image = shot({square(paint_of(four_fields()), {-odd, odd}, {odd, odd})}, 60);
    EXPECT_GT(test::coloured_pixels(image), 100) << odd;
  }
}

TEST(Texture, WhatDoesNotFitIsRefused) {
  EXPECT_FALSE(Mipmap::create(0, 1, {}).ok());
  EXPECT_FALSE(Mipmap::create(2, 2, std::vector<std::uint8_t>(12)).ok());
  EXPECT_FALSE(Mipmap::create(2, 2, std::vector<std::uint8_t>(17)).ok());
  const auto refused = [](const std::function<void(Paint&)>& spoil) {
    Surface surface = square(paint_of(four_fields()));
    Paint paint = *surface.paint;
    spoil(paint);
    surface.paint = std::make_shared<const Paint>(std::move(paint));
    Actor actor;
    actor.surfaces = {surface};
    const Status status = check(actor);
    return !status.ok() && status.error().code == "render-figure";
  };
  EXPECT_FALSE(refused([](Paint&) {}));
  EXPECT_TRUE(refused([](Paint& paint) { paint.image = nullptr; }));
  EXPECT_TRUE(refused([](Paint& paint) { paint.coordinates = nullptr; }));
  EXPECT_TRUE(refused([](Paint& paint) {
    paint.coordinates = std::make_shared<const std::vector<Vec2f>>(3, Vec2f(0, 0));
  }));
  EXPECT_TRUE(refused([](Paint& paint) {
    paint.coordinates = std::make_shared<const std::vector<Vec2f>>(
        4, Vec2f(0, std::numeric_limits<float>::quiet_NaN()));
  }));
  EXPECT_TRUE(refused([](Paint& paint) { paint.factor.x() = 1.5F; }));
  EXPECT_TRUE(
      refused([](Paint& paint) { paint.factor.w() = std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](Paint& paint) { paint.cutoff = -1; }));
}

}  // namespace
}  // namespace krok::render
