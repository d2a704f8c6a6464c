// If these fail, pictures cannot be opened, differ from run to run, or carry unreadable labels.

#include "render/image.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>

#include "render/text.h"

namespace krok::render {
namespace {

constexpr Colour kWhite = colour(0xFFFFFF);
constexpr Colour kBlack = colour(0x000000);

Image pattern() {
  Image image(37, 23, kWhite);
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 37; ++x) {
      image.set(x, y,
                {static_cast<std::uint8_t>(x * 7), static_cast<std::uint8_t>(y * 11),
                 static_cast<std::uint8_t>(x * y)});
    }
  }
  return image;
}

// The names of a PNG file's chunks, read by what the PNG specification says of them.
std::vector<std::string> chunks(const std::vector<std::byte>& png) {
  std::vector<std::string> names;
  for (std::size_t at = 8; at + 8 <= png.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      length = length << 8 | std::to_integer<std::size_t>(png[at + i]);
    }
    std::string name;
    for (std::size_t i = 4; i < 8; ++i) name += std::to_integer<char>(png[at + i]);
    if (names.empty() || names.back() != name) names.push_back(name);
    at += 12 + length;
  }
  return names;
}

TEST(Png, ComesBackAsItWas) {
  const Image image = pattern();
  const auto png = write_png(image);
  ASSERT_TRUE(png.ok());
  const auto back = read_png(*png);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->width, 37);
  EXPECT_EQ(back->height, 23);
  EXPECT_EQ(back->rgb, image.rgb);
}

TEST(Png, HoldsNoTimeAndSaysWhatItsColoursAre) {
  const auto png = write_png(pattern());
  ASSERT_TRUE(png.ok());
  const auto names = chunks(*png);
  EXPECT_THAT(names, testing::Contains("sRGB"));
  EXPECT_THAT(names, testing::Not(testing::Contains("tIME")));
  EXPECT_EQ(names.front(), "IHDR");
  EXPECT_EQ(names.back(), "IEND");
  EXPECT_EQ(*png, *write_png(pattern()));
}

TEST(Png, RefusesWhatIsNone) {
  EXPECT_EQ(write_png(Image()).error().code, "png-write");
  EXPECT_EQ(read_png({}).error().code, "png-read");
  auto png = *write_png(pattern());
  EXPECT_EQ(read_png(png, 100).error().code, "png-read") << "too many pixels";
  png.resize(png.size() / 2);
  EXPECT_EQ(read_png(png).error().code, "png-read");
}

TEST(Paint, EdgesBetweenPixelsCoverThemInPart) {
  Image image(4, 1, kWhite);
  fill(image, {{0.5, 0}, {3, 1}}, kBlack);
  EXPECT_NEAR(image.at(0, 0).red, 128, 1);
  EXPECT_EQ(image.at(1, 0), kBlack);
  EXPECT_EQ(image.at(2, 0), kBlack);
  EXPECT_EQ(image.at(3, 0), kWhite);
}

TEST(Paint, NothingHappensOutside) {
  Image image(8, 8, kWhite);
  const Image before = image;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  fill(image, {{-1e300, -9}, {-1, 1e300}}, kBlack);
  draw_line(image, {-50, -50}, {-1e9, -3}, 2, kBlack, {{0, 0}, {8, 8}});
  draw_line(image, {nan, 0}, {5, 5}, 2, kBlack, {{0, 0}, {8, 8}});
  image.blend(-1, 3, kBlack, 1);
  image.blend(3, 8, kBlack, 1);
  EXPECT_EQ(image.rgb, before.rgb);
}

TEST(Paint, ALineStaysInItsBox) {
  Image image(20, 20, kWhite);
  draw_line(image, {0, 10}, {20, 10}, 2, kBlack, {{5, 0}, {15, 20}});
  EXPECT_EQ(image.at(2, 9), kWhite);
  EXPECT_EQ(image.at(10, 9), kBlack);
  EXPECT_EQ(image.at(10, 10), kBlack);
  EXPECT_EQ(image.at(17, 9), kWhite);
  EXPECT_EQ(image.at(10, 14), kWhite);
}

class Text : public testing::Test {
 protected:
  Text() : painter_(std::move(TextPainter::create().value())) {}

  struct Ink {
    int left = 1000, right = -1, top = 1000, bottom = -1;
  };
  Ink drawn(const std::string& text, double size, Align align) {
    Image image(400, 100, kWhite);
    painter_.draw(image, {200, 50}, text, size, kBlack, align);
    Ink ink;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 400; ++x) {
        if (image.at(x, y).red > 128) continue;
        ink.left = std::min(ink.left, x);
        ink.right = std::max(ink.right, x);
        ink.top = std::min(ink.top, y);
        ink.bottom = std::max(ink.bottom, y);
      }
    }
    return ink;
  }

  TextPainter painter_;
};

// DejaVu Sans: digits are 1303 of 2048 units wide and 1493 high, by the typeface's own tables.
TEST_F(Text, HasTheTypefacesMeasures) {
  EXPECT_NEAR(painter_.width("0000", 100), 4 * 100 * 1303 / 2048.0, 0.01);
  const Ink ink = drawn("1", 40, Align::left);
  EXPECT_EQ(ink.bottom, 49) << "stands on its line";
  EXPECT_NEAR(ink.bottom + 1 - ink.top, 40 * 1493 / 2048.0, 1.0);
}

TEST_F(Text, StandsWhereItIsAligned) {
  const double width = painter_.width("HHH", 30);
  EXPECT_NEAR(drawn("HHH", 30, Align::left).left, 200, 4);
  EXPECT_NEAR(drawn("HHH", 30, Align::right).right, 200, 4);
  const Ink centred = drawn("HHH", 30, Align::centre);
  EXPECT_NEAR(0.5 * (centred.left + centred.right), 200, 1.5);
  EXPECT_NEAR(centred.right - centred.left, width, 8);
}

TEST_F(Text, IsShortenedToWhatFits) {
  EXPECT_EQ(painter_.fitted("walk.bvh", 12, 500), "walk.bvh");
  const std::string name = "h\u00e4user und stra\u00dfen.bvh";
  const std::string less = painter_.fitted(name, 12, 60);
  EXPECT_LE(painter_.width(less, 12), 60);
  EXPECT_THAT(less, testing::StartsWith("h\u00e4us"));
  EXPECT_THAT(less, testing::EndsWith("\u2026"));
  EXPECT_EQ(painter_.fitted(name, 12, 1), "");
}

TEST_F(Text, TakesAnyBytes) {
  for (const std::string& text : {std::string("\xff\xfe\0\x80", 4), std::string("\n\t\r"),
                                  std::string("\u6f22\u5b57 \U0001F600")}) {
    EXPECT_GT(painter_.width(text, 20), 0);
    EXPECT_GT(drawn(text, 20, Align::left).right, 0) << "something is shown";
  }
  EXPECT_EQ(painter_.width("", 20), 0);
}

}  // namespace
}  // namespace krok::render
