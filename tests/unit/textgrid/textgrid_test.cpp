// If these fail, a TextGrid or a table of intervals is misread, or a mistake in it is passed over,
// reported at the wrong place, or fatal.

#include "formats/textgrid/textgrid.h"

#include <gtest/gtest.h>

#include "support/told_mistakes.h"

namespace krok::textgrid {
namespace {

const std::string kLong = R"(File type = "ooTextFile"
Object class = "TextGrid"

xmin = 0
xmax = 1.5
tiers? <exists>
size = 2
item []:
    item [1]:
        class = "IntervalTier"
        name = "phones"
        xmin = 0
        xmax = 1.5
        intervals: size = 2
        intervals [1]:
            xmin = 0
            xmax = 0.5
            text = "m"
        intervals [2]:
            xmin = 0.5
            xmax = 1.5
            text = "he said ""ɑː"""
    item [2]:
        class = "TextTier"
        name = "bells"
        xmin = 0
        xmax = 1.5
        points: size = 1
        points [1]:
            number = 0.7
            mark = "x"
)";

const std::string kShort =
    "File type = \"ooTextFile\"\n\"TextGrid\"\n! a comment with 5 \"words\"\n0\n1.5\n<exists>\n2\n"
    "\"IntervalTier\"\n\"phones\"\n0\n1.5\n2\n0\n0.5\n\"m\"\n0.5\n1.5\n\"he said \"\"ɑː\"\"\"\n"
    "\"TextTier\"\n\"bells\"\n0\n1.5\n1\n0.7\n\"x\"\n";

void expect_good(const std::string& bytes) {
  const auto grid = read(bytes, "a.TextGrid");
  ASSERT_TRUE(grid.ok()) << grid.error().message;
  ASSERT_EQ(grid->tiers.size(), 2u);
  EXPECT_EQ(grid->end, 1.5);
  EXPECT_EQ(grid->tiers[0].name, "phones");
  ASSERT_EQ(grid->tiers[0].intervals.size(), 2u);
  EXPECT_EQ(grid->tiers[0].intervals[0].label, "m");
  EXPECT_EQ(grid->tiers[0].intervals[1].label, "he said \"ɑː\"");
  EXPECT_EQ(grid->tiers[0].intervals[1].start, 0.5);
  EXPECT_TRUE(grid->tiers[1].points);
  EXPECT_EQ(grid->tiers[1].intervals[0].start, 0.7);
}

// Of characters below U+10000.
std::string utf16(const std::string& text, bool little) {
  std::string bytes = little ? "\xFF\xFE" : "\xFE\xFF";
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned unit = static_cast<unsigned char>(text[i]);
    if (unit >= 0xC0) unit = (unit & 0x1F) << 6 | (static_cast<unsigned char>(text[++i]) & 0x3F);
    const char low = static_cast<char>(unit & 255), high = static_cast<char>(unit >> 8);
    bytes += little ? low : high;
    bytes += little ? high : low;
  }
  return bytes;
}

TEST(TextGrid, LongAndShortFormsInThreeEncodings) {
  for (const std::string& text : {kLong, kShort}) {
    expect_good(text);
    expect_good("\xEF\xBB\xBF" + text);
    expect_good(utf16(text, true));
    expect_good(utf16(text, false));
    std::string dos;
    for (const char c : text) dos += c == '\n' ? std::string("\r\n") : std::string(1, c);
    expect_good(dos);
  }
}

TEST(TextGrid, MistakesAreToldWithTheirPlace) {
  const struct {
    const char *from, *to, *place;
  } kMistakes[] = {{"ooTextFile", "ooFile", "textgrid-kind 1:13"},
                   {"\"TextGrid\"", "\"Pitch 1\"", "textgrid-kind 2:16"},
                   {"size = 2", "size = \"2\"", "textgrid-structure 7:8"},
                   {"\"IntervalTier\"", "\"Tier\"", "textgrid-structure 10:17"},
                   {"xmax = 0.5", "xmax = -1", "textgrid-time 17:20"},
                   {"xmin = 0.5", "xmin = 0.4", "textgrid-time 21:20"},
                   {"xmax = 0.5", "xmax = 1e9", "textgrid-value 17:20"},
                   {"mark = \"x\"", "mark = \"x", "textgrid-structure 31:20"}};
  for (const auto& mistake : kMistakes) {
    const auto grid = read(test::replaced(kLong, mistake.from, mistake.to), "a.TextGrid");
    ASSERT_FALSE(grid.ok()) << mistake.from;
    EXPECT_EQ(test::place_of(grid.error()), mistake.place);
    EXPECT_EQ(grid.error().where.file, "a.TextGrid");
  }
}

TEST(TextGrid, CutOffAnywhereIsAnErrorOrLess) {
  for (std::size_t size = 0; size + 3 < kLong.size(); ++size) {
    EXPECT_FALSE(read(kLong.substr(0, size), "a").ok()) << size;
  }
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    (void)read(test::damaged(kShort, random), "a");
    (void)read_intervals(test::damaged(kLong, random), "a", "");
  }
}

TEST(TextGrid, TiersAndTables) {
  EXPECT_EQ(read_intervals(kLong, "a", "")->size(), 2u);
  EXPECT_EQ(read_intervals(kLong, "a", "bells").error().code, "textgrid-tier");
  EXPECT_EQ(read_intervals(test::replaced(kLong, "phones", "sounds"), "a", "")->size(), 2u);
  const auto table = read_intervals("start,end,label\n0,0.5,m\n0.5,1,AA1\n", "a.csv", "");
  ASSERT_TRUE(table.ok());
  EXPECT_EQ(table->at(1).label, "AA1");
  EXPECT_EQ(table->at(1).where.line, 3);
  const auto back = read_intervals("start,end,label\n0,0.5,m\n0.4,1,AA1\n", "a.csv", "");
  EXPECT_EQ(test::place_of(back.error()), "textgrid-time 3:1");
  EXPECT_EQ(read_intervals("begin,end\n0,1\n", "a.csv", "").error().code, "csv-column");
}

}  // namespace
}  // namespace krok::textgrid
