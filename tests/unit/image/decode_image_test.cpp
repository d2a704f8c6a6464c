// If these fail, textures have other colours than their files, or a damaged or hostile picture
// brings down the tool that shows it.

#include "formats/image/decode_image.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "render/image.h"
#include "support/small_images.h"
#include "unit/image/made_images.h"

namespace krok::image {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string code_of(const std::vector<std::byte>& file, std::size_t most = kMaxPixels) {
  const auto pixels = decode(file, most);
  return pixels ? "" : pixels.error().code;
}

std::vector<int> pixel(const Pixels& pixels, int x, int y) {
  const auto first = pixels.rgba.begin() + 4 * (y * pixels.width + x);
  return {first, first + 4};
}

TEST(DecodeImage, PngHasTheColoursThatWerePutIn) {
  const auto pixels = decode(test::png());
  ASSERT_TRUE(pixels.ok()) << pixels.error().message;
  ASSERT_EQ(pixels->width, 2);
  ASSERT_EQ(pixels->height, 2);
  EXPECT_THAT(pixel(*pixels, 0, 0), ElementsAre(255, 0, 0, 255));
  EXPECT_THAT(pixel(*pixels, 1, 0), ElementsAre(0, 255, 0, 255));
  EXPECT_THAT(pixel(*pixels, 0, 1), ElementsAre(0, 0, 255, 255));
  EXPECT_THAT(pixel(*pixels, 1, 1), ElementsAre(255, 255, 255, 255));
}

TEST(DecodeImage, PalettesAndTheirAlphaAreWrittenOut) {
  const auto pixels = decode(test::bytes_of(test::kPalette));
  ASSERT_TRUE(pixels.ok()) << pixels.error().message;
  EXPECT_THAT(pixel(*pixels, 0, 0), ElementsAre(255, 0, 0, 255));
  EXPECT_THAT(pixel(*pixels, 1, 0), ElementsAre(0, 255, 0, 64));
  EXPECT_THAT(pixel(*pixels, 2, 0), ElementsAre(0, 0, 255, 255));
}

// The numbers stay what they are; libpng's simple way would brighten 0x80 to 0xBC.
TEST(DecodeImage, GammaDoesNotCountAndOf16BitsTheUpperAreKept) {
  const auto pixels = decode(test::bytes_of(test::kGrey16));
  ASSERT_TRUE(pixels.ok()) << pixels.error().message;
  EXPECT_THAT(pixel(*pixels, 0, 0), ElementsAre(0x80, 0x80, 0x80, 255));
  EXPECT_THAT(pixel(*pixels, 1, 0), ElementsAre(1, 1, 1, 255));
}

TEST(DecodeImage, JpegHasTheColoursThatAnotherProgramReads) {
  for (const auto file : {test::kJpegRgb, test::kJpegProgressive}) {
    const auto pixels = decode(test::bytes_of(file));
    ASSERT_TRUE(pixels.ok()) << pixels.error().message;
    ASSERT_EQ(pixels->width, 16);
    ASSERT_EQ(pixels->height, 8);
    EXPECT_EQ(pixels->damage, "");
    EXPECT_THAT(pixel(*pixels, 2, 3), ElementsAre(201, 40, 30, 255));
    EXPECT_THAT(pixel(*pixels, 12, 3), ElementsAre(20, 60, 181, 255));
  }
  const auto grey = decode(test::jpeg());
  ASSERT_TRUE(grey.ok()) << grey.error().message;
  const auto middle = pixel(*grey, 1, 0);
  EXPECT_EQ(middle[0], middle[1]);
  EXPECT_EQ(middle[1], middle[2]);
  EXPECT_EQ(middle[3], 255);
}

TEST(DecodeImage, PrintingInksAreRefused) {
  const auto pixels = decode(test::bytes_of(test::kJpegInks));
  ASSERT_FALSE(pixels.ok());
  EXPECT_EQ(pixels.error().code, "picture-kind");
  EXPECT_THAT(pixels.error().message, HasSubstr("CMYK"));
}

TEST(DecodeImage, MorePixelsThanAllowedAreRefusedBeforeTheyTakeMemory) {
  EXPECT_EQ(code_of(test::png(), 4), "");
  EXPECT_EQ(code_of(test::png(), 3), "picture-size");
  auto huge = test::png();
  huge[18] = huge[22] = std::byte{0x7F};  // 32514 a side: four gigabytes
  EXPECT_EQ(code_of(huge), "picture-size");
}

TEST(DecodeImage, APngThatEndsWithinItsPixelsIsDamaged) {
  // Whole chunks, so that picture_facts() finds nothing: the pixels of a picture, in a larger one.
  render::Image image(64, 64, render::colour(0x3D7FD9));
  auto file = *render::write_png(image);
  file[23] = std::byte{65};  // the height; its checksum is wrong now, too
  EXPECT_EQ(code_of(file), "picture-damaged");
}

// Each scan goes through the whole picture, and takes 14 bytes.
TEST(DecodeImage, AJpegOfEndlessScansIsRefused) {
  auto file = test::bytes_of(test::kJpegProgressive);
  const auto scan = test::bytes_of("ffda000c030100020003000000107f");
  for (int i = 0; i < 200; ++i) file.insert(file.end() - 2, scan.begin(), scan.end());
  const auto pixels = decode(file);
  ASSERT_FALSE(pixels.ok());
  EXPECT_EQ(pixels.error().code, "picture-damaged");
  EXPECT_THAT(pixels.error().message, HasSubstr("scans"));
}

TEST(DecodeImage, AJpegCutWithinItsPixelsShowsTheRestAndSaysSo) {
  auto file = test::bytes_of(test::kJpegRgb);
  file.erase(file.end() - 10, file.end() - 2);
  const auto pixels = decode(file);
  ASSERT_TRUE(pixels.ok()) << pixels.error().message;
  EXPECT_NE(pixels->damage, "");
}

// Best run with the sanitizers.
TEST(DecodeImage, OtherBytesAnywhereAreHandled) {
  std::mt19937 random(5);
  int decoded = 0, refused = 0;
  for (const auto& whole :
       {test::png(), test::jpeg(), test::bytes_of(test::kPalette), test::bytes_of(test::kGrey16),
        test::bytes_of(test::kJpegRgb), test::bytes_of(test::kJpegProgressive),
        test::bytes_of(test::kJpegInks)}) {
    for (int i = 0; i < 2000; ++i) {
      auto file = whole;
      for (unsigned changes = 1 + random() % 3; changes > 0; --changes) {
        file[random() % file.size()] = static_cast<std::byte>(random() % 256);
      }
      if (i % 4 == 0) file.resize(random() % file.size());
      const auto pixels = decode(file, 4096);
      ++(pixels ? decoded : refused);
      if (pixels) {
        EXPECT_EQ(pixels->rgba.size(), 4U * static_cast<unsigned>(pixels->width * pixels->height));
      } else {
        EXPECT_NE(pixels.error().message, "");
      }
    }
  }
  EXPECT_GT(decoded, 100);
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace krok::image
