// If these fail, a header that a person understands is refused, taken in silence, or read wrongly:
// decimal commas, rates in place of times, lines that other programs add.

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

const std::string kRows = "0 0 0 0 0 0 0 0 0\n1 1 1 1 1 1 1 1 1\n";

std::string headed(const std::string& header) {
  return kArm + "MOTION\n" + header + kRows;
}

// What is taken with a warning that has `code` and is refused by strict.
void expect_warning(const std::string& text, const std::string& code) {
  SCOPED_TRACE(text.substr(kArm.size()));
  const Capture capture = read_ok(text);
  EXPECT_EQ(capture.clip.frame_count(), 2);
  EXPECT_EQ(capture.clip.rate, 30.0);
  const Diagnostic* told = find(capture.diagnostics, code);
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->severity, Severity::warning);
  EXPECT_GE(told->where.line, 17);
  EXPECT_EQ(read_error(text, with(Strictness::strict)).code, code);
}

TEST(OddHeader, IsTakenWithAWarningAndRefusedByStrict) {
  const std::string time = "Frame Time: 0.0333333\n";
  expect_warning(headed("Frames: 2\nFrame Time: 0,0333333\n"), "bvh-frame-time");
  expect_warning(headed("Frames: 2\nFrame Time: 3,33333E-02\n"), "bvh-frame-time");
  expect_warning(headed("Frames: 2\nFrame Time: 0.0333333 seconds\n"), "bvh-syntax");
  expect_warning(headed("Frames: 2 in all\n" + time), "bvh-syntax");
  expect_warning(headed("Frames: 2.0\n" + time), "bvh-frame-count");
  expect_warning(headed("Frames: 2e0\n" + time), "bvh-frame-count");
  expect_warning(headed("Frames: 2\n" + time + "Frame Rate: 30\n"), "bvh-syntax");
  expect_warning(headed("Frames: 2\n" + time + "Frame Time: 0.01\n"), "bvh-syntax");
}

TEST(OddHeader, AFrameCountThatIsNoneIsCountedByRepair) {
  for (const char* count : {"-2", "six", "1,000", "", "99999999999999999999999", "2.5"}) {
    const std::string text = headed(std::string("Frames: ") + count + "\nFrame Time: 0.04\n");
    EXPECT_EQ(read_error(text).code, "bvh-frame-count") << count;
    EXPECT_NE(read_error(text).hint.find("--repair"), std::string::npos) << count;
    const Capture capture = read_ok(text, with(Strictness::repair));
    EXPECT_EQ(capture.clip.frame_count(), 2) << count;
    EXPECT_NE(find(capture.diagnostics, "bvh-frame-count"), nullptr) << count;
  }
}

TEST(OddHeader, AFrameTimeWithoutAValueDoesNotEatTheFirstRow) {
  const std::string text = headed("Frames: 2\nFrame Time:\n");
  EXPECT_EQ(read_error(text).code, "bvh-frame-time");
  ReadOptions options = plain_options();
  options.rate = 50;
  EXPECT_EQ(read_ok(text, options).clip.frame_count(), 2);
}

TEST(OddHeader, TheWordsMayShareALine) {
  const Capture capture = read_ok(headed("Frames: 2 Frame Time: 0.05\n"), with(Strictness::strict));
  EXPECT_EQ(capture.clip.frame_count(), 2);
  EXPECT_EQ(capture.clip.rate, 20.0);
}

}  // namespace
}  // namespace krok::bvh
