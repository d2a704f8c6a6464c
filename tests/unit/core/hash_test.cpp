// If these fail, checksums in files and reports are not those that other XXH3 programs compute.
#include "core/hash.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace krok {
namespace {

std::uint64_t of(std::string_view text) {
  return xxh3(std::as_bytes(std::span(text)));
}

// Values from `xxhsum -H3` of Debian's xxhash package, for texts on either side of the lengths at
// which the algorithm changes (16, 128, 240 and 1024 bytes).
TEST(Xxh3, AgreesWithXxhsum) {
  EXPECT_EQ(hex(of(std::string(0, 'a'))), "2d06800538d394c2");
  EXPECT_EQ(hex(of(std::string(1, 'a'))), "e6c632b61e964e1f");
  EXPECT_EQ(hex(of(std::string(3, 'a'))), "e4ba3228795dc9ef");
  EXPECT_EQ(hex(of(std::string(8, 'a'))), "c9dbc05573cd5d9a");
  EXPECT_EQ(hex(of(std::string(16, 'a'))), "13ba5039476cd10a");
  EXPECT_EQ(hex(of(std::string(17, 'a'))), "39127b6816c5f92a");
  EXPECT_EQ(hex(of(std::string(128, 'a'))), "7a22200aadc3d36c");
  EXPECT_EQ(hex(of(std::string(129, 'a'))), "1586e7ed07cba75b");
  EXPECT_EQ(hex(of(std::string(240, 'a'))), "993c46d96a01b5c6");
  EXPECT_EQ(hex(of(std::string(241, 'a'))), "f6cfef5c5aca1930");
  EXPECT_EQ(hex(of(std::string(1024, 'a'))), "4a5d6b09a9587a1c");
  EXPECT_EQ(hex(of(std::string(1025, 'a'))), "d46a63acfb8da1ea");
  EXPECT_EQ(hex(of(std::string(5000, 'a'))), "86bab6aca5d8f5e9");
}

TEST(Xxh3Stream, AgreesForAnyPieces) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += static_cast<char>(i * 31 % 251);
  for (const std::size_t piece :
       {std::size_t{1}, std::size_t{7}, std::size_t{64}, std::size_t{4999}}) {
    Xxh3Stream stream;
    for (std::size_t at = 0; at < text.size(); at += piece) {
      stream.update(std::as_bytes(std::span(std::string_view(text).substr(at, piece))));
    }
    EXPECT_EQ(stream.digest(), of(text)) << piece;
  }
}

TEST(Xxh3Stream, OfNothingIsThatOfAnEmptyText) {
  Xxh3Stream stream;
  stream.update({});
  EXPECT_EQ(stream.digest(), of(""));
}

TEST(Hex, HasSixteenDigits) {
  EXPECT_EQ(hex(0), "0000000000000000");
  EXPECT_EQ(hex(0xABCDEF), "0000000000abcdef");
  EXPECT_EQ(hex(~std::uint64_t{0}), "ffffffffffffffff");
}

}  // namespace
}  // namespace krok
