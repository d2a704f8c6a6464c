// If these fail, names that JSON and glTF cannot hold get into files, or good ones are refused;
// messages point to wrong places, or a file's control characters reach a terminal.

#include "core/text.h"

#include <gtest/gtest.h>

#include <algorithm>

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

TEST(ToUtf8, ReadsTheRestAsLatin1) {
  EXPECT_EQ(to_utf8("K\xc3\xb6rper"), "K\xc3\xb6rper");
  EXPECT_EQ(to_utf8("K\xf6rper"), "K\xc3\xb6rper");
  EXPECT_EQ(to_utf8("\x80\xff"), "\xc2\x80\xc3\xbf");
  EXPECT_EQ(to_utf8(""), "");
}

TEST(Shown, IsShortAndFitForATerminal) {
  EXPECT_EQ(shown("a\tb\x1b[31m\x7f"), "a?b?[31m?");
  EXPECT_EQ(shown(std::string(40, 'x')), std::string(40, 'x'));
  EXPECT_EQ(shown(std::string(41, 'x')), std::string(40, 'x') + "...");
  // Never cut inside of a character.
  for (std::size_t before = 30; before < 45; ++before) {
    const std::string text =
        shown(std::string(before, 'x') + "\xf0\x9f\xa6\xb4\xe8\x85\xb0yyyyyyyyy");
    EXPECT_TRUE(is_utf8(text)) << before;
    EXPECT_EQ(text.find('\xc3'), std::string::npos) << before;  // nothing was read as Latin-1
  }
}

TEST(SameWord, CaseOfAsciiLettersAlone) {
  EXPECT_TRUE(same_word("Hips", "hIPS"));
  EXPECT_TRUE(same_word("", ""));
  EXPECT_FALSE(same_word("Hips", "Hip"));
  EXPECT_FALSE(same_word("@", "`"));
  EXPECT_FALSE(same_word("[", "{"));
  EXPECT_FALSE(same_word("\xc3\x84", "\xc3\xa4"));
  EXPECT_EQ(ascii_lower("AZaz[@\xc3\x84"), "azaz[@\xc3\x84");
}

TEST(Trimmed, TakesWhiteSpaceFromBothEnds) {
  EXPECT_EQ(trimmed(" \t a b\r\n"), "a b");
  EXPECT_EQ(trimmed(" \v\f"), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(WithoutByteOrderMark, TakesAWholeMarkAlone) {
  EXPECT_EQ(without_byte_order_mark("\xef\xbb\xbfHi"), "Hi");
  EXPECT_EQ(without_byte_order_mark("\xef\xbb"), "\xef\xbb");
  EXPECT_EQ(without_byte_order_mark(""), "");
}

// The plain definition: a line ends with LF, or with a CR that no LF follows.
Location counted(std::string_view text, std::size_t offset) {
  Location where;
  where.line = where.column = 1;
  for (std::size_t i = 0; i < std::min(offset, text.size()); ++i) {
    const bool ends = text[i] == '\n' || (text[i] == '\r' && text.substr(i + 1, 1) != "\n");
    where.line += ends ? 1 : 0;
    where.column = ends ? 1 : where.column + 1;
  }
  return where;
}

TEST(Locator, FindsEveryByteForwardsAndBackwards) {
  const std::string text = "ab\ncd\r\nef\r\rg\n\nh\r";
  const std::string name = "a.bvh";
  Locator forwards(text, name), backwards(text, name);
  for (std::size_t i = 0; i < text.size() + 3; ++i) {
    const Location expected = counted(text, i);
    const Location found = forwards(i);
    EXPECT_EQ(found.line, expected.line) << i;
    EXPECT_EQ(found.column, expected.column) << i;
    EXPECT_EQ(found.file, name);
    const std::size_t back = text.size() - std::min(i, text.size());
    EXPECT_EQ(backwards(back).line, counted(text, back).line) << back;
    EXPECT_EQ(locate(text, back, name).column, counted(text, back).column) << back;
  }
  EXPECT_EQ(locate("", 0, name).line, 1);
  EXPECT_EQ(locate("", 0, name).column, 1);
}

// A name in a file that reaches a terminal could otherwise recolour it, move the cursor or make
// "name" read as another one.
TEST(Printable, HasNothingThatATerminalObeys) {
  EXPECT_EQ(printable("a\x1b[31mb\x7f\r"), "a?[31mb??");
  EXPECT_EQ(printable("a\xc2\x9b"
                      "31m\xc2\x80"),
            "a?31m?");
  EXPECT_EQ(printable("a\xe2\x80\xae"
                      "b\xe2\x81\xa6"),
            "a?b?");
  EXPECT_EQ(printable("\xc3\xa9 \xc2\xa0 \xe2\x80\x94 \xe9\xa0\xad"),
            "\xc3\xa9 \xc2\xa0 \xe2\x80\x94 \xe9\xa0\xad");
  EXPECT_EQ(printable("a\tb\n"), "a?b?");
  EXPECT_EQ(printable("a\tb\n", true), "a\tb\n");
  EXPECT_EQ(printable("\xc2"), "\xc2");
  EXPECT_EQ(shown("x\xc2\x9by"), "x?y");
}

}  // namespace
}  // namespace krok
