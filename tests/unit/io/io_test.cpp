// If these fail, a program that links the library cannot read files as the tools do, or a result
// does not know what it depends on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "formats/io/formats.h"
#include "formats/io/open_scene.h"
#include "formats/io/readers_internal.h"
#include "support/folder_test.h"
#include "support/glb_builder.h"
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

class OpenFiles : public test::FolderTest {
 protected:
  std::string put_rig(const test::GlbBuilder& rig) const {
    const auto bytes = rig.glb();
    return put("rig.glb", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
};

TEST(Formats, EachRowReadsSomethingAndHasAName) {
  std::set<Kind> kinds;
  for (const Format& format : formats()) {
    const bool reads =
        format.read_motion || format.open_capture || format.read_scene || format.read_actor;
    if (format.kind == Kind::unknown) continue;  // added by another test
    EXPECT_TRUE(reads || !format.companion) << registry::kind_name(format.kind);
    EXPECT_TRUE(kinds.insert(format.kind).second) << registry::kind_name(format.kind);
    EXPECT_NE(registry::kind_name(format.kind), "unknown");
    EXPECT_FALSE(format.read_motion && format.open_capture) << "two ways to read a motion";
    // The ending leads back to the row where the content does not decide.
    for (const std::string& ending : registry::endings_of(format.kind)) {
      if (ending == ".ragdoll.json") continue;
      EXPECT_EQ(registry::kind_of_name("x" + ending), format.kind);
    }
  }
  EXPECT_EQ(format_of(Kind::unknown).read_motion, nullptr);
  EXPECT_EQ(format_of(Kind::unknown).open_capture, nullptr);
}

// A made-up format: "dots", then the height of a single joint in each frame.
Result<Clip> read_dots(std::string_view content, const std::string& file_name) {
  Clip clip;
  clip.skeleton.add("Dot", -1, {});
  std::istringstream text{std::string(content)};
  std::string word;
  text >> word;
  for (float height = 0; text >> height;) {
    clip.positions.emplace_back(0.0F, height, 0.0F);
    clip.orientations.push_back(Quatf::Identity());
  }
  if (Status status = check(clip); !status) return std::move(status).error().in_file(file_name);
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
              .read_motion = motion_of<read_dots>});
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
  EXPECT_THAT(motion_endings(),
              testing::ElementsAre(".anim", ".kanim", ".bvh", ".amc", ".glb", ".vrm", ".vrma",
                                   ".gltf", ".npy", ".npz", ".zip", ".fbx", ".dae", ".smd", ".ms3d",
                                   ".3ds", ".ase", ".md5anim", ".dots"));
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

// Folders of takes in formats of scenes would be skipped or refused.
TEST_F(OpenFiles, ASceneIsReadAsAMotion) {
  const std::string path = put_rig(test::rig());
  RecordedInputs inputs;
  const auto clip = open_motion(path, inputs);
  ASSERT_TRUE(clip) << clip.error().message;
  EXPECT_EQ(clip->skeleton.names, (std::vector<std::string>{"Root", "Tip"}));
  EXPECT_EQ(clip->rate, 30);  // keys at 0, 0.5 and 1 s
  EXPECT_EQ(clip->frame_count(), 31);
  EXPECT_FALSE(clip->provenance.conversions.empty());
  const auto summary = stream_motion(path, inputs, [](const FrameSource&) -> Status { return {}; });
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->conversions, clip->provenance.conversions);
  test::GlbBuilder still = test::rig();
  still.json.erase("animations");
  const auto none = open_motion(put_rig(still), inputs);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, "motion-missing");
}

TEST_F(OpenFiles, AnActorHasWhatTheFileHolds) {
  RecordedInputs inputs;
  const auto scene = open_actor(put_rig(test::rig()), inputs);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->model.vertex_count(), 4);
  EXPECT_TRUE(scene->has_mesh());
  ASSERT_EQ(scene->motions.size(), 1u);
  EXPECT_EQ(scene->motions[0].clip.frame_count(), 31);
  const auto motion = open_actor(capture(), inputs);
  ASSERT_TRUE(motion) << motion.error().message;
  EXPECT_FALSE(motion->has_mesh());
  EXPECT_EQ(motion->skeleton().names, motion->motions.at(0).clip.skeleton.names);
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
        open_actor(*file, inputs).error(), open_motion(path("none.bvh"), inputs).error()}) {
    EXPECT_FALSE(error.code.empty());
    EXPECT_NE(error.where.file, "") << error.code;
  }
}

}  // namespace
}  // namespace krok::io
