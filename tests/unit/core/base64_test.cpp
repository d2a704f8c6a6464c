// If these fail, data that files and pages hold as text are other data.

#include "core/text.h"

#include <gtest/gtest.h>

#include <span>
#include <string_view>

namespace krok {
namespace {

std::string base64(std::string_view text) {
  return to_base64(std::as_bytes(std::span(text.data(), text.size())));
}

TEST(Base64, GivesTheVectorsOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
}

TEST(Base64, GivesTheSameTextInPiecesOfThreeBytes) {
  const std::string whole = "a text of some length, in pieces";
  std::string pieces;
  for (std::size_t i = 0; i < whole.size(); i += 6) pieces += base64(whole.substr(i, 6));
  EXPECT_EQ(pieces, base64(whole));
}

}  // namespace
}  // namespace krok
