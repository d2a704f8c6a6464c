// If these fail, frames come at wrong times, or one that is missing or not whole goes by without a
// word.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "math/quaternion.h"
#include "unit/acclaim/reading.h"
#include "unit/acclaim/small_files.h"

namespace krok::acclaim::test {
namespace {

using small_files::kAmc;
using small_files::kAsf;
using small_files::with;
using testing::HasSubstr;

TEST(AcclaimReader, a_skeleton_alone_is_a_clip_without_frames) {
  const auto capture = krok::acclaim::read(kAsf, "s.asf", {}, {}, plain());
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->clip.frame_count(), 0);
  EXPECT_EQ(capture->clip.joint_count(), 7);
  const auto empty = krok::acclaim::read(kAsf, "s.asf", {}, "m.amc", plain());
  ASSERT_FALSE(empty.ok());
  EXPECT_EQ(empty.error().code, "acclaim-kind");
  EXPECT_EQ(empty.error().where.file, "m.amc");
}

TEST(AcclaimReader, the_rate_is_given_or_read_or_120_with_a_warning) {
  auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->clip.rate, 120.0);
  EXPECT_TRUE(told(*capture, "acclaim-rate", "120 frames per second")) << all(*capture);
  capture = read(kAsf, with(kAmc, ":DEGREES", ":SAMPLES-PER-SECOND 60\n:DEGREES"));
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->clip.rate, 60.0);
  ReadOptions options = plain();
  options.rate = 30.0;
  capture = read(kAsf, kAmc, options);
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->clip.rate, 30.0);
  EXPECT_FALSE(told(*capture, "acclaim-rate", "")) << all(*capture);
  options.rate = 0.0;
  ASSERT_FALSE(read(kAsf, kAmc, options).ok());
}

TEST(AcclaimReader, numbers_of_frames_may_begin_anywhere_and_go_up_by_a_step) {
  std::string amc =
      with(with(with(kAmc, "\n1\n", "\n101\n"), "\n2\n", "\n105\n"), "\n3\n", "\n109\n");
  const auto capture = read(kAsf, amc);
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->first_frame_number, 101);
  EXPECT_EQ(capture->clip.frame_count(), 3);
  EXPECT_EQ(capture->clip.rate, 30.0);
  EXPECT_TRUE(told(*capture, "acclaim-rate", "increase by 4")) << all(*capture);
}

TEST(AcclaimReader, a_rest_frame_before_the_motion_is_told_and_left_out_where_asked) {
  std::string amc =
      ":FULLY-SPECIFIED\n:DEGREES\n5\nroot 0 9 0 0 0 0\nthigh 0 0\nshin 0\ntail 0 2\n";
  for (int i = 6; i < 16; ++i) {
    amc += std::to_string(i) + "\nroot " + std::to_string(i) + " 9 0 0 60 0\nthigh " +
           std::to_string(40 + i) + " 20\nshin 50\ntail 0 2\n";
  }
  const auto kept = read(kAsf, amc);
  ASSERT_TRUE(kept.ok());
  EXPECT_TRUE(kept->rest_frame_found);
  EXPECT_TRUE(told(*kept, "acclaim-rest-frame", "it was kept")) << all(*kept);
  EXPECT_EQ(kept->clip.frame_count(), 11);
  EXPECT_EQ(kept->first_frame_number, 5);
  ReadOptions options = plain();
  options.rest_frame = RestFrame::automatic;
  const auto dropped = read(kAsf, amc, options);
  ASSERT_TRUE(dropped.ok());
  EXPECT_TRUE(dropped->rest_frame_dropped);
  EXPECT_EQ(dropped->clip.frame_count(), 10);
  EXPECT_EQ(dropped->first_frame_number, 6);
  expect_near(position(*dropped, 0, "root"), Vec3(6, 9, 0));
  options.rest_frame = RestFrame::drop;
  const auto alone = krok::acclaim::read(kAsf, "s.asf", {}, {}, options);
  ASSERT_TRUE(alone.ok());
  EXPECT_EQ(alone->clip.frame_count(), 0);
}

TEST(AcclaimReader, gaps_close_or_are_filled_or_refused) {
  const std::string amc = with(kAmc, "\n3\n", "\n5\n");
  const auto closed = read(kAsf, amc);
  ASSERT_TRUE(closed.ok());
  EXPECT_EQ(closed->clip.frame_count(), 3);
  EXPECT_TRUE(told(*closed, "acclaim-frame", "2 is followed by 5")) << all(*closed);
  const auto filled = read(kAsf, amc, strictness(Strictness::repair));
  ASSERT_TRUE(filled.ok());
  ASSERT_EQ(filled->clip.frame_count(), 5);
  EXPECT_EQ(filled->repairs.size(), 1u);
  expect_near(position(*filled, 4, "shin"), position(*closed, 2, "shin"));
  // A third of the way the root has turned back from 90 to 60 degrees.
  const auto orientation = filled->clip.frame_orientations(2)[0].cast<double>();
  EXPECT_LT(krok::angle_between(orientation, krok::axis_rotation(krok::Axis::y, krok::kPi / 3)),
            1e-6);
  const auto refused = read(kAsf, amc, strictness(Strictness::strict));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, "acclaim-frame");
  const auto huge =
      read(kAsf, with(kAmc, "\n3\n", "\n9000000000000000000\n"), strictness(Strictness::repair));
  ASSERT_FALSE(huge.ok());
  EXPECT_EQ(huge.error().code, "acclaim-limit");
}

TEST(AcclaimReader, a_bone_that_a_frame_leaves_out_stays_as_it_was) {
  const std::string amc =
      with(kAmc, "3\nroot 1 9 0 0 0 0\nthigh 90 90\n", "3\nroot 1 9 0 0 90 0\n") +
      "4\nroot 1 9 0 0 0 0\nthigh 90 90\n" + "shin 0\ntail 0 2\n";
  const auto capture = read(kAsf, amc);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture->clip.frame_count(), 4);
  expect_near(position(*capture, 2, "shin"), position(*capture, 1, "shin"));
  EXPECT_TRUE(told(*capture, "acclaim-missing", "thigh")) << all(*capture);
  for (const auto& d : capture->diagnostics) {
    if (d.code != "acclaim-missing") continue;
    EXPECT_EQ(d.where.line, 14);  // the number of frame 3
  }
  const auto refused = read(kAsf, amc, strictness(Strictness::strict));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, "acclaim-missing");
  EXPECT_THAT(refused.error().message, HasSubstr("frame 3 has no values for thigh"));
}

TEST(AcclaimReader, a_last_frame_that_is_cut_short_is_left_out) {
  for (const char* end : {"shin 0\ntail 0 2\n", "tail 0 2\n", " 2\n", "2\n"}) {
    const std::string amc = kAmc.substr(0, kAmc.rfind(end));
    const auto capture = read(kAsf, amc);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    EXPECT_EQ(capture->clip.frame_count(), 2) << amc.substr(amc.size() - 20);
    EXPECT_TRUE(told(*capture, "acclaim-cut", "frame 3")) << all(*capture);
    EXPECT_FALSE(read(kAsf, amc, strictness(Strictness::strict)).ok());
  }
}

}  // namespace
}  // namespace krok::acclaim::test
