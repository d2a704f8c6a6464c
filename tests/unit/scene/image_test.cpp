// If these fail, a picture that is none, or is damaged, gets into a file that other programs then
// refuse, or a good one is left out.

#include "scene/encoded_image.h"

#include <gtest/gtest.h>

#include "support/small_images.h"

namespace krok {
namespace {

std::string code_of_image(const std::vector<std::byte>& bytes) {
  const auto facts = image_info(bytes);
  return facts ? "" : facts.error().code;
}

TEST(ImageInfo, AreThoseThatAnotherProgramWrote) {
  const auto png = image_info(test::png());
  ASSERT_TRUE(png.ok()) << png.error().message;
  EXPECT_EQ(png->kind, ImageKind::png);
  EXPECT_EQ(png->width, 2);
  EXPECT_EQ(png->height, 2);
  const auto jpeg = image_info(test::jpeg());
  ASSERT_TRUE(jpeg.ok()) << jpeg.error().message;
  EXPECT_EQ(jpeg->kind, ImageKind::jpeg);
  EXPECT_EQ(jpeg->width, 3);
  EXPECT_EQ(jpeg->height, 1);
}

// What is not decoded here but passed on: its size is read where glTF's viewers read it.
TEST(ImageInfo, WebpAndKtxAreKnownByTheirHeaders) {
  for (const auto& webp : {test::webp(), test::lossy_webp(), test::transparent_webp()}) {
    const auto facts = image_info(webp);
    ASSERT_TRUE(facts.ok()) << facts.error().message;
    EXPECT_EQ(facts->kind, ImageKind::webp);
    EXPECT_EQ(facts->width, 3);
    EXPECT_EQ(facts->height, 2);
  }
  const auto ktx = image_info(test::ktx2(64, 32, 16));
  ASSERT_TRUE(ktx.ok()) << ktx.error().message;
  EXPECT_EQ(ktx->kind, ImageKind::ktx2);
  EXPECT_EQ(ktx->width, 64);
  EXPECT_EQ(ktx->height, 32);
  EXPECT_EQ(code_of_image(test::ktx2(64, 0, 16)), "picture-size");
}

TEST(ImageInfo, EveryTruncationIsTold) {
  for (const auto& whole : {test::png(), test::jpeg(), test::webp(), test::lossy_webp(),
                            test::transparent_webp(), test::ktx2(4, 4, 16)}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::vector<std::byte> cut(whole.begin(), whole.begin() + static_cast<long>(size));
      EXPECT_NE(code_of_image(cut), "") << size;
    }
  }
}

TEST(ImageInfo, OtherKindsAreTold) {
  EXPECT_EQ(code_of_image({}), "picture-kind");
  for (const char* start : {"GIF89a......", "RIFF....WAVEfmt ", "BM..........", "DDS ......."}) {
    const std::string text = start;
    const auto bytes = std::as_bytes(std::span(text));
    EXPECT_EQ(code_of_image({bytes.begin(), bytes.end()}), "picture-kind") << start;
  }
}

TEST(ImageInfo, SizesBeyondReasonAreTold) {
  auto png = test::png();
  for (const std::size_t at : {16, 20}) {  // width, height
    auto odd = png;
    odd[at + 2] = std::byte{0x80};  // 32768 and some
    EXPECT_EQ(code_of_image(odd), "picture-size");
    odd = png;
    odd[at + 3] = std::byte{0};
    EXPECT_EQ(code_of_image(odd), "picture-size");
  }
}

TEST(ImageInfo, AnyByteMayBeWrong) {
  for (const auto& whole : {test::png(), test::jpeg()}) {
    for (std::size_t at = 0; at < whole.size(); ++at) {
      for (const int value : {0x00, 0x7F, 0xD9, 0xFF}) {
        auto bytes = whole;
        bytes[at] = static_cast<std::byte>(value);
        const auto facts = image_info(bytes);
        if (!facts) continue;
        EXPECT_GE(facts->width, 1);
        EXPECT_LE(facts->width, kMaxPixelsASide);
        EXPECT_GE(facts->height, 1);
        EXPECT_LE(facts->height, kMaxPixelsASide);
      }
    }
  }
}

}  // namespace
}  // namespace krok
