// If these fail, a program that links the library cannot read files as the tools do, or a result
// does not know what it depends on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "formats/io/formats.h"
#include "formats/io/open_scene.h"
#include "support/folder_test.h"
#include "unit/acclaim/small_files.h"

namespace krok::io {
namespace {

using registry::Kind;

// What was opened, beside what PlainInputs does.
class RecordedInputs : public PlainInputs {
 public:
  std::vector<std::string> opened, neighbours;
  Result<InputFile> open_input(const std::string& path) override {
    opened.push_back(path);
    return PlainInputs::open_input(path);
  }
  void depends_on_neighbours(const std::string& /*path*/, const std::string& ending) override {
    neighbours.push_back(ending);
  }
};

std::string capture() {
  return KROK_SOURCE_DIR "/samples/captures/walk.bvh";
}

using OpenFiles = test::FolderTest;

TEST(Formats, EachRowReadsSomethingAndHasAName) {
  std::set<Kind> kinds;
  for (const Format& format : formats()) {
    EXPECT_TRUE(kinds.insert(format.kind).second) << registry::kind_name(format.kind);
    EXPECT_NE(registry::kind_name(format.kind), "unknown");
    EXPECT_TRUE(format.read_motion || format.open_capture || format.read_scene ||
                format.read_model);
    EXPECT_FALSE(format.read_motion && format.open_capture) << "two ways to read a motion";
    // The ending leads back to the row where the content does not decide.
    const std::string name = "x." + std::string(registry::kind_name(format.kind));
    EXPECT_EQ(registry::kind_of_name(name), format.kind);
  }
  EXPECT_EQ(format_of(Kind::unknown).read_motion, nullptr);
  EXPECT_EQ(format_of(Kind::unknown).open_capture, nullptr);
}

TEST(Formats, AStreamHasTheFramesOfTheClip) {
  RecordedInputs inputs;
  const auto clip = open_motion(capture(), inputs);
  ASSERT_TRUE(clip) << clip.error().message;
  int frames_used = 0;
  const auto summary = stream_motion(capture(), inputs, [&](const FrameSource& frames) -> Status {
    const auto loaded = load(frames, 1);
    if (!loaded) return loaded.error();
    frames_used = loaded->frame_count();
    EXPECT_EQ(loaded->positions, clip->positions);
    return {};
  });
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(frames_used, clip->frame_count());
  EXPECT_EQ(summary->frame_count, clip->frame_count());
  EXPECT_EQ(summary->rate, clip->rate);
  EXPECT_EQ(summary->conversions, clip->provenance.conversions);
  EXPECT_THAT(inputs.opened, testing::ElementsAre(capture(), capture()));
}

TEST(Formats, TheErrorOfAUserOfAStreamIsPassedOn) {
  PlainInputs inputs;
  const auto summary = stream_motion(
      capture(), inputs, [](const FrameSource&) -> Status { return Error("mine", "enough"); });
  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().code, "mine");
}

TEST_F(OpenFiles, AMotionOpensItsSkeletonAndReportsTheChoice) {
  put("small.asf", small_files::kAsf);
  const std::string motion = put("small_01.amc", small_files::kAmc);
  RecordedInputs inputs;
  const auto clip = open_motion(motion, inputs);
  ASSERT_TRUE(clip) << clip.error().message;
  EXPECT_THAT(inputs.opened, testing::ElementsAre(motion, path("small.asf")));
  EXPECT_THAT(inputs.neighbours, testing::ElementsAre(".asf"));
  EXPECT_THAT(inputs.diagnostics,
              testing::Contains(testing::Field(&Diagnostic::code, "acclaim-skeleton")));

  const auto skeleton = open_motion(path("small.asf"), inputs);
  ASSERT_FALSE(skeleton);
  EXPECT_EQ(skeleton.error().code, "usage");
}

TEST_F(OpenFiles, WhatIsNotOfTheKindIsAnErrorWithTheFile) {
  const std::string page = put("page.html", "<html></html>");
  PlainInputs inputs;
  const auto file = inputs.open_input(page);
  ASSERT_TRUE(file);
  for (const Error& error :
       {open_motion(page, inputs).error(), open_scene(*file, inputs).error(),
        open_shown_model(*file, inputs).error(), open_motion(path("none.bvh"), inputs).error()}) {
    EXPECT_FALSE(error.code.empty());
    EXPECT_NE(error.where.file, "") << error.code;
  }
}

}  // namespace
}  // namespace krok::io
