// Damaged files: each prefix of a small ASF and AMC, and each byte of them changed. If these fail,
// a damaged file crashes or hangs a tool, or is read as a clip that fails check().

#include <gtest/gtest.h>

#include <set>

#include "formats/acclaim/acclaim_reader.h"
#include "unit/acclaim/small_files.h"

namespace {

using std::string_literals::operator""s;
using krok::Strictness;
using small_files::kAmc;
using small_files::kAsf;

struct Outcome {
  int read = 0, refused = 0;
};

void read_all_ways(const std::string& asf, const std::string& amc, Outcome& outcome) {
  for (const Strictness strictness : {Strictness::normal, Strictness::strict, Strictness::repair}) {
    krok::acclaim::ReadOptions options;
    options.strictness = strictness;
    options.jobs = 1;
    const auto capture = krok::acclaim::read(asf, "s.asf", amc, "m.amc", options);
    if (capture.ok()) {
      ++outcome.read;
      const auto whole = check(capture->clip);
      ASSERT_TRUE(whole.ok()) << whole.error().message << "\n" << asf << amc;
      ASSERT_EQ(capture->freedoms.size(), capture->clip.skeleton.names.size());
    } else {
      ++outcome.refused;
      const krok::Error& error = capture.error();
      ASSERT_TRUE(error.code.starts_with("acclaim-")) << error.code;
      ASSERT_FALSE(error.message.empty());
      ASSERT_TRUE(error.where.file == "s.asf" || error.where.file == "m.amc") << error.message;
    }
  }
}

TEST(AcclaimFuzz, every_prefix_of_both_files) {
  Outcome outcome;
  for (std::size_t n = 0; n <= kAsf.size(); ++n) read_all_ways(kAsf.substr(0, n), kAmc, outcome);
  // Only the final line ending may be missing; anything shorter is an error.
  EXPECT_LE(outcome.read, 3 * 2);
  EXPECT_GE(outcome.read, 3);
  outcome = Outcome();
  for (std::size_t n = 0; n <= kAmc.size(); ++n) read_all_ways(kAsf, kAmc.substr(0, n), outcome);
  EXPECT_GT(outcome.read, 0);
  EXPECT_GT(outcome.refused, 0);
}

TEST(AcclaimFuzz, every_byte_changed) {
  const std::string values = "\0\xFF\n\r :#-9eE.(\tl"s;
  Outcome outcome;
  for (const bool in_asf : {true, false}) {
    const std::string& original = in_asf ? kAsf : kAmc;
    for (std::size_t i = 0; i < original.size(); ++i) {
      for (const char value : values) {
        std::string changed = original;
        changed[i] = value;
        read_all_ways(in_asf ? changed : kAsf, in_asf ? kAmc : changed, outcome);
      }
    }
  }
  EXPECT_GT(outcome.read, 1000);
  EXPECT_GT(outcome.refused, 1000);
}

TEST(AcclaimFuzz, every_line_left_out_or_doubled) {
  Outcome outcome;
  for (const bool in_asf : {true, false}) {
    const std::string& original = in_asf ? kAsf : kAmc;
    for (std::size_t begin = 0; begin < original.size();) {
      const std::size_t end = original.find('\n', begin) + 1;
      const std::string line = original.substr(begin, end - begin);
      for (const std::string& instead : {std::string(), line + line}) {
        const std::string changed = original.substr(0, begin) + instead + original.substr(end);
        read_all_ways(in_asf ? changed : kAsf, in_asf ? kAmc : changed, outcome);
      }
      begin = end;
    }
  }
  EXPECT_GT(outcome.read, 0);
  EXPECT_GT(outcome.refused, 0);
}

}  // namespace
