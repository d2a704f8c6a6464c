// If these fail, rows that do not fit the hierarchy become a motion of nonsense, or one fault in
// them spoils all that follow.

#include <cmath>

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

std::string repeated_row(int frame, int values = 9) {
  std::string text;
  for (int i = 0; i < values; ++i) text += std::to_string(frame) + " ";
  return text + "\n";
}

// The root's x in each frame.
std::vector<int> frames_of(const Capture& capture) {
  std::vector<int> frames;
  for (int f = 0; f < capture.clip.frame_count(); ++f) {
    frames.push_back(static_cast<int>(std::lround(capture.clip.frame_positions(f)[0].x())));
  }
  return frames;
}

TEST(OddRows, RowsThatAllHaveTooManyOrTooFewValuesAreAnError) {
  for (const int values : {3, 8, 10, 12, 13}) {
    std::string rows;
    for (int f = 0; f < 6; ++f) rows += repeated_row(f, values);
    for (const Strictness strictness :
         {Strictness::normal, Strictness::strict, Strictness::repair}) {
      const Error error = read_error(kArm + motion(6, rows), with(strictness));
      EXPECT_EQ(error.code, "bvh-channel-count") << values;
      EXPECT_EQ(error.where.line, 19) << values;
    }
  }
}

TEST(OddRows, AValueMissingInAWrappedRowCostsThatRowAlone) {
  std::string rows;
  for (int f = 0; f < 6; ++f)
    rows += repeated_row(f, 4) + repeated_row(f, f == 2 ? 3 : 4) + repeated_row(f, 1);
  EXPECT_EQ(frames_of(read_ok(kArm + motion(6, rows))), (std::vector<int>{0, 1, 3, 4, 5}));
  EXPECT_EQ(frames_of(read_ok(kArm + motion(6, rows), with(Strictness::repair))),
            (std::vector<int>{0, 1, 2, 3, 4, 5}));
  const Error error = read_error(kArm + motion(6, rows), with(Strictness::strict));
  EXPECT_EQ(error.code, "bvh-channel-count");
  EXPECT_EQ(error.where.line, 19 + 6);
}

TEST(OddRows, LinesOfTextBetweenRowsAreNoFrames) {
  const std::string rows =
      repeated_row(0) + "# note\n" + repeated_row(1) + "cut here\n" + repeated_row(2);
  const Capture capture = read_ok(kArm + motion(3, rows));
  EXPECT_EQ(frames_of(capture), (std::vector<int>{0, 1, 2}));
  const Diagnostic* told = find(capture.diagnostics, "bvh-syntax");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->severity, Severity::warning);
  EXPECT_EQ(told->where.line, 20);
  EXPECT_EQ(find(capture.diagnostics, "bvh-frame-count"), nullptr);
  EXPECT_EQ(read_error(kArm + motion(3, rows), with(Strictness::strict)).code, "bvh-syntax");
}

TEST(OddRows, ASecondFileBehindTheFirstIsLeftOutWithAWarning) {
  const std::string once = kArm + motion(2, repeated_row(0) + repeated_row(1));
  for (const std::string& rest : {once, motion(2, repeated_row(5) + repeated_row(6))}) {
    const Capture capture = read_ok(once + rest);
    EXPECT_EQ(frames_of(capture), (std::vector<int>{0, 1}));
    const Diagnostic* told = find(capture.diagnostics, "bvh-text-after");
    ASSERT_NE(told, nullptr);
    EXPECT_EQ(told->severity, Severity::warning);
    EXPECT_NE(told->message.find("a second"), std::string::npos);
    EXPECT_EQ(read_error(once + rest, with(Strictness::strict)).code, "bvh-text-after");
  }
}

TEST(OddRows, WhereNoRowIsWholeRepairHasNothingToGoBy) {
  const std::string rows = "nan 0 0 0 0 0 0 0 0\nnan 1 1 1 1 1 1 1 1\n";
  EXPECT_EQ(read_error(kArm + motion(2, rows), with(Strictness::repair)).code, "bvh-number");
}

TEST(OddRows, TheHintTellsWhatDividesValues) {
  const auto hint = [](const std::string& first) {
    return read_error(kArm + motion(2, repeated_row(0) + first + " 1 1 1 1 1 1 1 1\n")).hint;
  };
  EXPECT_NE(hint("0,5").find("--repair reads decimal commas"), std::string::npos);
  EXPECT_NE(hint("0.5,").find("blanks"), std::string::npos);
  EXPECT_NE(hint("1;2").find("blanks"), std::string::npos);
  EXPECT_NE(hint("-nan(ind)").find("--repair"), std::string::npos);
}

// As exporters write that put no blank before a sign. In one row only, in all, and in an OFFSET;
// the other rows have as many words as the hierarchy has channels.
TEST(OddRows, NumbersWithoutABlankBetweenAreNamedAndSplitByRepair) {
  const std::string good = "0 1.5 0 0 0 0 0 0 0\n", glued = "0 1.5 0.0-7.5094748 0 0 0 1e-1-2\n";
  for (const auto& [rows, line] : std::vector<std::pair<std::string, int>>{
           {glued + glued, 19}, {good + glued, 20}, {glued + good, 19}}) {
    for (const Strictness strictness : {Strictness::normal, Strictness::strict}) {
      const Error error = read_error(kArm + motion(2, rows), with(strictness));
      EXPECT_EQ(error.code, "bvh-number");
      EXPECT_EQ(error.where.line, line);
      EXPECT_EQ(error.where.column, 7);
      EXPECT_NE(error.message.find("'0.0-7.5094748' is 2 numbers"), std::string::npos);
      EXPECT_NE(error.hint.find("--repair splits"), std::string::npos);
    }
  }
  std::string hierarchy = kArm;
  hierarchy.replace(hierarchy.find("OFFSET 1 0 0"), 12, "OFFSET 1-2.5 0");
  EXPECT_NE(read_error(hierarchy + motion(1, good)).hint.find("--repair splits"),
            std::string::npos);
  const Capture capture = read_ok(hierarchy + motion(2, glued + glued), with(Strictness::repair));
  const Capture apart = read_ok(kArm + motion(1, "0 1.5 0.0 -7.5094748 0 0 0 1e-1 -2\n"));
  EXPECT_EQ(capture.clip.skeleton.reference[1].position, Vec3(1, -2.5, 0));
  EXPECT_EQ(capture.clip.frame_count(), 2);
  ASSERT_EQ(capture.repairs.size(), 1u);
  EXPECT_EQ(find(capture.diagnostics, "bvh-repair")->where.line, 8);
  EXPECT_TRUE(capture.clip.frame_orientations(1)[1].coeffs() ==
              apart.clip.frame_orientations(0)[1].coeffs());
}

TEST(OddRows, DecimalCommasAreReadByRepair) {
  const std::string rows = "0,5 0 0 0 0 0 0 0 0\n1,5 1 1 1 1 1 1 1 -1,25E+1\n";
  std::string hierarchy = kArm;
  hierarchy.replace(hierarchy.find("OFFSET 1 0 0"), 12, "OFFSET 1,5 0 0");
  const std::string text = hierarchy + motion(2, rows, "0,0333333");
  EXPECT_EQ(read_error(text).code, "bvh-number");
  const Capture capture = read_ok(text, with(Strictness::repair));
  EXPECT_EQ(capture.clip.rate, 30.0);
  EXPECT_FLOAT_EQ(capture.clip.frame_positions(1)[0].x(), 1.5f);
  EXPECT_DOUBLE_EQ(capture.clip.skeleton.reference[1].position.x(), 1.5);
  ASSERT_EQ(capture.repairs.size(), 1u);
  const Diagnostic* told = find(capture.diagnostics, "bvh-repair");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->where.line, 8);
  // A point elsewhere leaves open what a comma means.
  EXPECT_FALSE(
      read(kArm + motion(2, rows, "0.0333333"), "test.bvh", with(Strictness::repair)).ok());
}

}  // namespace
}  // namespace krok::bvh
