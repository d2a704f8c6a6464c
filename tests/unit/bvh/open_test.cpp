// If these fail, a long capture that is read block by block gives another motion than one that is
// read as a whole, or a fault in it passes unnoticed.

#include <cstring>
#include <filesystem>

#include "core/file.h"
#include "formats/bvh/motion_rows.h"
#include "scene/frame_source.h"
#include "support/this_build.h"
#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

std::string rows(int frames) {
  std::string text;
  for (int f = 0; f < frames; ++f) {
    for (int c = 0; c < 9; ++c) text += std::to_string(f * 0.37 + c) + (c == 8 ? "\n" : " ");
  }
  return text;
}

void expect_same(const Clip& a, const Clip& b, const std::string& name) {
  EXPECT_EQ(a.rate, b.rate) << name;
  EXPECT_EQ(a.skeleton.names, b.skeleton.names) << name;
  EXPECT_EQ(a.provenance.conversions, b.provenance.conversions) << name;
  ASSERT_EQ(a.positions.size(), b.positions.size()) << name;
  ASSERT_EQ(a.orientations.size(), b.orientations.size()) << name;
  if (a.positions.empty()) return;
  EXPECT_EQ(std::memcmp(a.positions.data(), b.positions.data(), a.positions.size() * sizeof(Vec3f)),
            0)
      << name;
  EXPECT_EQ(std::memcmp(a.orientations.data(), b.orientations.data(),
                        a.orientations.size() * sizeof(Quatf)),
            0)
      << name;
}

// Whether the file could be opened; if so, and all frames were whole, they are those of read().
bool opened_as_read(std::string_view text, const std::string& name, const ReadOptions& options) {
  const auto opened = open(text, name, options);
  if (!opened) return false;
  auto clip = load(opened->frames, 2);
  const auto whole = read(text, name, options);
  if (!clip) return false;
  EXPECT_TRUE(whole.ok()) << name;
  if (!whole.ok()) return false;
  clip->provenance = opened->clip.provenance;
  expect_same(*clip, whole->clip, name);
  EXPECT_TRUE(check(*clip)) << name;
  EXPECT_EQ(opened->clip.frame_count(), 0);
  EXPECT_EQ(opened->rest_frame_found, whole->rest_frame_found) << name;
  EXPECT_EQ(opened->rest_frame_dropped, whole->rest_frame_dropped) << name;
  EXPECT_EQ(opened->diagnostics.size(), whole->diagnostics.size()) << name;
  for (std::size_t i = 0; i < opened->diagnostics.size(); ++i) {
    EXPECT_EQ(opened->diagnostics[i].message, whole->diagnostics[i].message) << name;
  }
  return true;
}

TEST(Open, GivesTheFramesOfRead) {
  for (const int frames : {1, 2, 15, 16, 17, 1000}) {
    EXPECT_TRUE(opened_as_read(kArm + motion(frames, rows(frames)), "x.bvh", plain_options()));
    EXPECT_TRUE(opened_as_read(kArm + motion(frames, rows(frames)), "x.bvh", {}));
  }
  ReadOptions options = plain_options();
  options.rest_frame = RestFrame::drop;
  EXPECT_TRUE(opened_as_read(kArm + motion(40, rows(40)), "x.bvh", options));
}

TEST(Open, LeavesFaultyFilesToRead) {
  const auto cannot = [](const std::string& text) {
    const auto opened = open(text, "x.bvh", plain_options());
    return !opened || !load(opened->frames, 2);
  };
  EXPECT_FALSE(cannot(kArm + motion(100, rows(100))));
  EXPECT_TRUE(cannot(kArm + motion(101, rows(100))));
  EXPECT_TRUE(cannot(kArm + motion(99, rows(100))));
  EXPECT_TRUE(cannot(kArm));
  EXPECT_TRUE(cannot(""));
  for (const std::string row : {"1 2 3 4 5 6 7 8\n", "1 2 3 4 5 6 7 8 9 10\n",
                                "1 2 3 4 nan 6 7 8 9\n", "1 2 3 4 5 6 7 8 1e5 \n",
                                // Of these read() has something to tell.
                                "1 2 3 4 5 6 7 8 1e7\n", "1 2 1e9 4 5 6 7 8 9\n"}) {
    std::string text = rows(100) + row + rows(100);
    EXPECT_EQ(cannot(kArm + motion(201, text)), row.find("e5") == std::string::npos) << row;
  }
  EXPECT_TRUE(cannot(kArm + motion(3,
                                   "1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9\n3e38 3e38 3e38 4 5 6 "
                                   "7 8 9e38\n")));
}

// Lines are looked for in stretches of a megabyte.
TEST(Open, FindsLinesWhateverTheStretch) {
  std::string text = "not a line";
  const std::size_t begin = text.size();
  std::vector<std::size_t> expected;
  const auto add = [&](std::size_t indent, std::size_t length) {
    text += std::string(indent, ' ');
    if (length > 0) expected.push_back(text.size());
    text += std::string(length, '1') + "\n";
  };
  for (int i = 0; i < 30000; ++i)
    add(static_cast<std::size_t>(i % 3), static_cast<std::size_t>(i % 101));
  add(0, 3 << 20);
  add(0, 0);
  add(5, 1);
  // A line that begins just at, before and after a border.
  for (const int off : {-1, 0, 1}) {
    const std::size_t border = (text.size() - begin + (1 << 20)) / (1 << 20) * (1 << 20) + begin;
    add(0, border - text.size() - 1 + static_cast<std::size_t>(off + 1) - 1);
    add(0, 10);
  }
  for (const int jobs : {1, 2, 3}) EXPECT_EQ(index_lines(text, begin, jobs), expected);
  text += "  12";
  expected.push_back(text.size() - 2);
  EXPECT_EQ(index_lines(text, begin, 2), expected);
  EXPECT_TRUE(index_lines("", 0).empty());
  EXPECT_TRUE(index_lines("ab", 2).empty());
}

TEST(Open, TellsWhichTextIsDone) {
  const std::string text = kArm + motion(1000, rows(1000));
  std::size_t before = 0;
  bool increasing = true;
  const auto opened = open(text, "x.bvh", plain_options(), [&](std::size_t offset) {
    increasing = increasing && offset >= before;
    before = offset;
  });
  ASSERT_TRUE(opened);
  before = 0;
  ASSERT_TRUE(load(opened->frames, 2));
  EXPECT_TRUE(increasing);
  EXPECT_GT(before, text.size() / 2);
  EXPECT_LT(before, text.size());
}

TEST(Open, GivesTheFramesOfReadForTheCorpus) {
  const std::string corpus = test::corpus_folder() + "/bvh";
  if (!std::filesystem::exists(corpus)) GTEST_SKIP() << "skipped: no corpus at " << corpus;
  int files = 0, opened = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(corpus)) {
    if (entry.path().extension() != ".bvh" || entry.file_size() > (1u << 20)) continue;
    const auto file = InputFile::open(entry.path().string());
    ASSERT_TRUE(file.ok());
    ++files;
    if (opened_as_read(file->text(), entry.path().filename().string(), {})) ++opened;
  }
  // Nearly all real files have a row a line.
  EXPECT_GT(opened, files * 3 / 4) << files;
}

}  // namespace
}  // namespace krok::bvh
