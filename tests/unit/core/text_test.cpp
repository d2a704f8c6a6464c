// If these fail, names that JSON and glTF cannot hold get into files, or good ones are refused.
#include "core/text.h"

#include <gtest/gtest.h>

namespace krok {
namespace {

TEST(IsUtf8, TakesWellFormedText) {
  for (const char* text : {"", "Hips", "\x7f", "K\xc3\xb6rper", "\xe8\x85\xb0", "\xf0\x9f\xa6\xb4",
                           "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                           "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"}) {
    EXPECT_TRUE(is_utf8(text)) << text;
  }
}

TEST(IsUtf8, RefusesTheRest) {
  for (const char* text :
       {"\x80", "K\xf6rper", "\xc3", "\xc3(", "\xc0\xaf", "\xc1\xbf", "\xe0\x9f\xbf", "\xe8\x85",
        "\xed\xa0\x80", "\xed\xbf\xbf", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80",
        "\xff", "a\xf0\x9f\xa6"}) {
    EXPECT_FALSE(is_utf8(text)) << testing::PrintToString(text);
  }
}

}  // namespace
}  // namespace krok
