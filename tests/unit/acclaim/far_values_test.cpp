// If these fail, one damaged number of an AMC makes a motion of nonsense without a word.

#include <gtest/gtest.h>

#include "unit/acclaim/reading.h"
#include "unit/acclaim/small_files.h"

namespace krok::acclaim::test {
namespace {

using small_files::kAmc;
using small_files::kAsf;
using small_files::with;

const Diagnostic* find(const Capture& capture, const std::string& code) {
  for (const Diagnostic& told : capture.diagnostics) {
    if (told.code == code) return &told;
  }
  return nullptr;
}

TEST(AcclaimFarValues, APlainMotionHasNone) {
  const auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(find(*capture, "acclaim-far-rotation"), nullptr);
  EXPECT_EQ(find(*capture, "acclaim-far-position"), nullptr);
}

TEST(AcclaimFarValues, ARotationIsToldWithJointFrameAndLine) {
  const auto capture = read(kAsf, with(kAmc, "shin 90\n", "shin -36000090\n"));
  ASSERT_TRUE(capture.ok());
  const Diagnostic* told = find(*capture, "acclaim-far-rotation");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->severity, Severity::warning);
  EXPECT_EQ(told->joint, "shin");
  EXPECT_EQ(told->frame, 1);
  EXPECT_EQ(told->where.file, "m.amc");
  EXPECT_EQ(told->where.line, 9);  // where the frame begins
  EXPECT_NE(told->message.find("shin rx"), std::string::npos) << told->message;
  EXPECT_EQ(find(*capture, "acclaim-far-position"), nullptr);
}

// In a file of radians the limit is as many radians.
TEST(AcclaimFarValues, RadiansAreMeasuredInDegrees) {
  const std::string radians = with(kAmc, ":DEGREES", ":RADIANS");
  const auto capture = read(kAsf, with(radians, "shin 90\n", "shin 20000\n"));
  ASSERT_TRUE(capture.ok());
  EXPECT_NE(find(*capture, "acclaim-far-rotation"), nullptr) << all(*capture);
  const auto near = read(kAsf, with(radians, "shin 90\n", "shin 17000\n"));
  ASSERT_TRUE(near.ok());
  EXPECT_EQ(find(*near, "acclaim-far-rotation"), nullptr) << all(*near);
}

TEST(AcclaimFarValues, APositionIsToldOnceHoweverManyFrames) {
  std::string amc = with(kAmc, "root 1 9 0 0 90 0", "root 1 9e8 0 0 90 0");
  amc = with(amc, "root 1 9 0 0 0 0", "root 1 9e8 0 0 0 0");
  const auto capture = read(kAsf, amc);
  ASSERT_TRUE(capture.ok());
  const Diagnostic* told = find(*capture, "acclaim-far-position");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->joint, "root");
  EXPECT_EQ(told->frame, 1);
  EXPECT_EQ(told->where.line, 9);
  EXPECT_NE(told->message.find("2 frames"), std::string::npos) << told->message;
}

TEST(AcclaimFarValues, StrictRefuses) {
  const auto capture =
      read(kAsf, with(kAmc, "shin 90\n", "shin 9e8\n"), strictness(Strictness::strict));
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-far-rotation");
  EXPECT_EQ(capture.error().where.file, "m.amc");
}

}  // namespace
}  // namespace krok::acclaim::test
