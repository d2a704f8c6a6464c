// If these fail, a picture that is none, or is damaged, gets into a file that other programs then
// refuse, or a good one is left out.

#include "scene/picture.h"

#include <gtest/gtest.h>

#include "support/small_pictures.h"

namespace krok {
namespace {

std::string code_of_picture(const std::vector<std::byte>& bytes) {
  const auto facts = picture_facts(bytes);
  return facts ? "" : facts.error().code;
}

TEST(PictureFacts, AreThoseThatAnotherProgramWrote) {
  const auto png = picture_facts(test::png());
  ASSERT_TRUE(png.ok()) << png.error().message;
  EXPECT_EQ(png->kind, PictureKind::png);
  EXPECT_EQ(png->width, 2);
  EXPECT_EQ(png->height, 2);
  const auto jpeg = picture_facts(test::jpeg());
  ASSERT_TRUE(jpeg.ok()) << jpeg.error().message;
  EXPECT_EQ(jpeg->kind, PictureKind::jpeg);
  EXPECT_EQ(jpeg->width, 3);
  EXPECT_EQ(jpeg->height, 1);
}

TEST(PictureFacts, EveryTruncationIsTold) {
  for (const auto& whole : {test::png(), test::jpeg()}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::vector<std::byte> cut(whole.begin(), whole.begin() + static_cast<long>(size));
      EXPECT_NE(code_of_picture(cut), "") << size;
    }
  }
}

TEST(PictureFacts, OtherKindsAreTold) {
  EXPECT_EQ(code_of_picture({}), "picture-kind");
  for (const char* start : {"GIF89a......", "RIFF....WEBPVP8 ", "BM..........", "DDS ......."}) {
    const std::string text = start;
    const auto bytes = std::as_bytes(std::span(text));
    EXPECT_EQ(code_of_picture({bytes.begin(), bytes.end()}), "picture-kind") << start;
  }
}

TEST(PictureFacts, SizesBeyondReasonAreTold) {
  auto png = test::png();
  for (const std::size_t at : {16, 20}) {  // width, height
    auto odd = png;
    odd[at + 2] = std::byte{0x80};  // 32768 and some
    EXPECT_EQ(code_of_picture(odd), "picture-size");
    odd = png;
    odd[at + 3] = std::byte{0};
    EXPECT_EQ(code_of_picture(odd), "picture-size");
  }
}

TEST(PictureFacts, AnyByteMayBeWrong) {
  for (const auto& whole : {test::png(), test::jpeg()}) {
    for (std::size_t at = 0; at < whole.size(); ++at) {
      for (const int value : {0x00, 0x7F, 0xD9, 0xFF}) {
        auto bytes = whole;
        bytes[at] = static_cast<std::byte>(value);
        const auto facts = picture_facts(bytes);
        if (!facts) continue;
        EXPECT_GE(facts->width, 1);
        EXPECT_LE(facts->width, kMostPixelsASide);
        EXPECT_GE(facts->height, 1);
        EXPECT_LE(facts->height, kMostPixelsASide);
      }
    }
  }
}

}  // namespace
}  // namespace krok
