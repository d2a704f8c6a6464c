// If these fail, a name in a chart or on a page ends its element, or makes a file that no XML
// reader takes.

#include "core/text.h"

#include <gtest/gtest.h>

namespace krok {
namespace {

TEST(Markup, EscapesWhatMarkupIsMadeOf) {
  EXPECT_EQ(to_markup("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
  EXPECT_EQ(to_markup(""), "");
  EXPECT_EQ(to_markup("W\xC3\xA4nde 'x'|\ty\n"), "W\xC3\xA4nde 'x'|\ty\n");
}

// Source: W3C, Extensible Markup Language 1.0, production 2 (Char).
TEST(Markup, HasNoCharacterThatXmlHasNot) {
  EXPECT_EQ(to_markup(std::string("a\0b\x1B"
                                  "c\rd",
                                  7)),
            "a?b?c?d");
  EXPECT_EQ(to_markup("a\xEF\xBF\xBE"
                      "b\xEF\xBF\xBF"
                      "c\xEF\xBF\xBD"),
            "a?b?c\xEF\xBF\xBD");
}

// A chart or page in a terminal or an editor would colour it, or show its text in another order.
TEST(Markup, HasNoControlsAboveAscii) {
  EXPECT_EQ(to_markup("a\xC2\x9B"
                      "31m\x7F\xE2\x80\xAE"
                      "b"),
            "a?31m??b");
}

TEST(Markup, BytesThatAreNoUtf8AreLatin1) {
  EXPECT_EQ(to_markup("\xE4<"), "\xC3\xA4&lt;");
}

}  // namespace
}  // namespace krok
