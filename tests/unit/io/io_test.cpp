// If these fail, a program that links the library cannot read files as the tools do, or a result
// does not know what it depends on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "formats/io/formats.h"
#include "formats/io/open_scene.h"
#include "support/folder_test.h"
#include "support/this_build.h"
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
  return test::source_folder() + "/samples/captures/walk.bvh";
}

using OpenFiles = test::FolderTest;

TEST(Formats, EachRowReadsSomethingAndHasAName) {
  std::set<Kind> kinds;
  for (const Format& format : formats()) {
    if (format.kind == Kind::unknown) continue;  // added by another test
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

// A made-up format: "dots", then the height of a single joint in each frame.
Result<Clip> read_dots(const InputFile& file, Inputs& /*inputs*/,
                       const MotionOptions& /*options*/) {
  Clip clip;
  clip.skeleton.add("Dot", -1, {});
  std::istringstream text{std::string(file.text())};
  std::string word;
  text >> word;
  for (float height = 0; text >> height;) {
    clip.positions.emplace_back(0.0F, height, 0.0F);
    clip.orientations.push_back(Quatf::Identity());
  }
  if (Status status = check(clip); !status) return std::move(status).error().in_file(file.path());
  return clip;
}

// A new format is a reader and a row: what opens motions takes it by its content, or by its ending.
TEST_F(OpenFiles, AFormatThatIsAddedIsReadLikeAnyOther) {
  put("a.txt", "dots 1 2 3");
  put("b.dots", "# 1 2");
  RecordedInputs inputs;
  ASSERT_FALSE(open_motion(path("a.txt"), inputs));
  add_format({.ending = "dots",
              .recognises =
                  [](std::span<const std::byte> content) {
                    return std::string_view(reinterpret_cast<const char*>(content.data()),
                                            content.size())
                        .starts_with("dots");
                  },
              .read_motion = read_dots});
  const auto by_content = open_motion(path("a.txt"), inputs);
  ASSERT_TRUE(by_content) << by_content.error().message;
  EXPECT_EQ(by_content->frame_count(), 3);
  EXPECT_EQ(by_content->positions[2].y(), 3);
  const auto by_ending = open_motion(path("b.dots"), inputs);
  ASSERT_TRUE(by_ending) << by_ending.error().message;
  int frames = 0;
  ASSERT_TRUE(stream_motion(path("a.txt"), inputs, [&](const FrameSource& source) -> Status {
    frames = source.frame_count;
    return {};
  }));
  EXPECT_EQ(frames, 3);
  // krok-import reads it, too, and folders are searched for it.
  const auto file = inputs.open_input(path("a.txt"));
  ASSERT_TRUE(file);
  EXPECT_TRUE(is_motion(*file));
  frames = 0;
  const Status imported =
      use_capture(*file, inputs, {}, false, [&](const OpenedCapture& opened) -> Status {
        frames = opened.frames.frame_count;
        return {};
      });
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(frames, 3);
  EXPECT_THAT(motion_endings(), testing::ElementsAre(".anim", ".kanim", ".bvh", ".amc", ".dots"));
  // What is known goes before what a program added.
  EXPECT_GT(open_motion(capture(), inputs)->frame_count(), 3);
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
