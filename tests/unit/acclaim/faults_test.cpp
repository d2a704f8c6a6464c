// If these fail, a faulty file is read, is refused without its place, or takes memory out of all
// proportion to its size.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/acclaim/reading.h"
#include "unit/acclaim/small_files.h"

namespace krok::acclaim::test {
namespace {

using small_files::kAmc;
using small_files::kAsf;
using small_files::with;
using testing::HasSubstr;

struct Faulty {
  const char* what;
  std::string asf, amc;
  const char* code;
  int line, column;
  const char* message;
};

void PrintTo(const Faulty& faulty, std::ostream* out) {
  *out << faulty.what;
}

class AcclaimErrors : public testing::TestWithParam<Faulty> {};

TEST_P(AcclaimErrors, report_file_line_and_column) {
  const Faulty& faulty = GetParam();
  const auto capture = read(faulty.asf, faulty.amc);
  ASSERT_FALSE(capture.ok()) << all(*capture);
  const krok::Error& error = capture.error();
  EXPECT_EQ(error.code, faulty.code);
  EXPECT_THAT(error.message, HasSubstr(faulty.message));
  EXPECT_EQ(error.where.line, faulty.line) << error.message;
  EXPECT_EQ(error.where.column, faulty.column) << error.message;
  EXPECT_EQ(error.where.file, faulty.asf == kAsf ? "m.amc" : "s.asf");
}

INSTANTIATE_TEST_SUITE_P(
    all, AcclaimErrors,
    testing::Values(
        Faulty{"swapped", kAmc, kAsf, "acclaim-kind", 0, 0, "motion (AMC)"},
        Faulty{"number", with(kAsf, "length 4", "length 4m"), kAmc, "acclaim-number", 21, 12,
               "'4m' in the length of the bone thigh"},
        Faulty{"nan", with(kAsf, "axis 0 90", "axis 0 nan"), kAmc, "acclaim-number", 33, 12, "nan"},
        Faulty{"dof", with(kAsf, "dof rz rx", "dof rz rw"), kAmc, "acclaim-dof", 23, 12, "'rw'"},
        Faulty{"dof_twice", with(kAsf, "dof rz rx", "dof rz rz"), kAmc, "acclaim-dof", 23, 12,
               "twice"},
        Faulty{"no_length", with(kAsf, "    length 4\n", ""), kAmc, "acclaim-bone", 19, 10,
               "thigh has no length"},
        Faulty{"no_name", with(kAsf, "name thigh", "name"), kAmc, "acclaim-bone", 17, 3,
               "has no name"},
        Faulty{"same_name", with(kAsf, "name tip", "name tail"), kAmc, "acclaim-bone", 48, 10,
               "second bone is named tail"},
        Faulty{"no_end", with(kAsf, "  end\n  begin\n    id 2", "  begin\n    id 2"), kAmc,
               "acclaim-syntax", 27, 3, "'end' of the bone thigh is missing"},
        Faulty{"order", with(kAsf, "axis 0 90 0 XYZ", "axis 0 90 0 XXZ"), kAmc, "acclaim-syntax",
               33, 17, "'XXZ'"},
        Faulty{"unknown_child", with(kAsf, "thigh shin", "thigh shim"), kAmc, "acclaim-hierarchy",
               56, 11, "shim"},
        Faulty{"two_parents", with(kAsf, "tail tip", "tail tip shin"), kAmc, "acclaim-hierarchy",
               57, 14, "second parent"},
        Faulty{"unit", with(kAsf, "length 1.0", "length 0"), kAmc, "acclaim-number", 6, 10,
               "not positive"},
        Faulty{"angle", with(kAsf, "angle deg", "angle grad"), kAmc, "acclaim-syntax", 7, 9,
               "grad"},
        Faulty{"value", kAsf, with(kAmc, "root 1 9 0 0 90 0", "root 1 9 0 0 9o 0"),
               "acclaim-number", 10, 14, "'9o' in the values of root"},
        Faulty{"infinity", kAsf, with(kAmc, "shin 90", "shin inf"), "acclaim-number", 12, 6, "inf"},
        Faulty{"few", kAsf, with(kAmc, "thigh 0 90", "thigh 0"), "acclaim-values", 11, 1,
               "1 value for thigh, expected 2 (rz rx)"},
        Faulty{"many", kAsf, with(kAmc, "shin 90", "shin 90 1"), "acclaim-values", 12, 1,
               "2 values for shin, expected 1 (rx)"},
        Faulty{"other_bone", kAsf, with(kAmc, "shin 90", "shim 90"), "acclaim-unknown-bone", 12, 1,
               "no bone shim"},
        Faulty{"twice", kAsf, with(kAmc, "\n3\n", "\n"), "acclaim-frame", 14, 1,
               "frame 2 has root twice"},
        Faulty{"no_frame", kAsf, with(kAmc, "\n1\n", "\n"), "acclaim-syntax", 4, 1,
               "number of the first frame"}),
    [](const auto& test) { return test.param.what; });

TEST(AcclaimReader, repair_leaves_out_lines_that_cannot_be_read_and_lists_them) {
  const std::string amc = with(with(kAmc, "thigh 0 90", "thigh 0 9o"), "shin 90", "shim 90");
  const auto capture = read(kAsf, amc, strictness(Strictness::repair));
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture->clip.frame_count(), 3);
  ASSERT_EQ(capture->repairs.size(), 2u);
  EXPECT_THAT(capture->repairs[0], HasSubstr("line 11 skipped: '9o'"));
  expect_near(position(*capture, 1, "shin"), {1, 5, 0});
}

TEST(AcclaimReader, deep_hierarchies_and_many_frames_are_bounded) {
  std::string asf = ":units\n length 1\n:root\n order tx ty tz\n:bonedata\n";
  std::string hierarchy = ":hierarchy\nbegin\nroot b0\n";
  constexpr int kBones = 30000;
  for (int i = 0; i < kBones; ++i) {
    asf += fmt::format("begin\nname b{}\ndirection 0 1 0\nlength 0.01\naxis 0 0 0 xyz\nend\n", i);
    if (i > 0) hierarchy += fmt::format("b{} b{}\n", i - 1, i);
  }
  asf += hierarchy + "end\n";
  std::string amc = ":FULLY-SPECIFIED\n1\nroot 0 0 0\n";
  auto capture = read(asf, amc, ReadOptions());
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture->clip.joint_count(), kBones + 2);
  EXPECT_NEAR(capture->clip.skeleton.reference.back().position.y(),
              300 * capture->conventions.unit.metres, 1e-6);
  for (int i = 2; i < 100000; ++i) amc += fmt::format("{}\n", i);
  capture = read(asf, amc);
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-limit");
  ReadOptions few = plain();
  few.max_joints = 4;
  capture = read(kAsf, kAmc, few);
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-limit");
}

TEST(AcclaimReader, numbers_that_overflow_are_an_error) {
  auto capture = read(with(kAsf, "length 4", "length 1e300"), kAmc);
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-number");
  capture = read(kAsf, with(kAmc, "root 1 9 0", "root 1e300 9 0"));
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-number");
}

}  // namespace
}  // namespace krok::acclaim::test
