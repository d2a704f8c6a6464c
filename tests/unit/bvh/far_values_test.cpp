// If these fail, one damaged number makes a motion of nonsense without a word, or motions that are
// sound are warned of.

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

// Rows of small numbers, in which some are replaced: {row, channel, text}.
struct Damage {
  int row, channel;
  const char* text;
};

std::string damaged_rows(int count, const std::vector<Damage>& damages) {
  std::string text;
  for (int r = 0; r < count; ++r) {
    for (int c = 0; c < 9; ++c) {
      std::string value = std::to_string((r + c) % 7 * 10);
      for (const Damage& damage : damages) {
        if (damage.row == r && damage.channel == c) value = damage.text;
      }
      text += value + (c == 8 ? "\n" : " ");
    }
  }
  return kArm + motion(count, text);
}

int warnings(const Capture& capture) {
  int count = 0;
  for (const Diagnostic& told : capture.diagnostics) count += told.severity == Severity::warning;
  return count;
}

constexpr int kFirstRowLine = 19;

TEST(FarValues, ARotationBeyondSenseIsToldOnceWithItsPlace) {
  for (const int jobs : {1, 3}) {
    ReadOptions options = plain_options();
    options.jobs = jobs;
    const Capture capture = read_ok(
        damaged_rows(300, {{290, 3, "-4e7"}, {130, 8, "12345678.5"}, {130, 4, "1e9"}}), options);
    EXPECT_EQ(warnings(capture), 1);
    const Diagnostic* told = find(capture.diagnostics, "bvh-far-rotation");
    ASSERT_NE(told, nullptr);
    EXPECT_EQ(told->severity, Severity::warning);
    EXPECT_EQ(told->frame, 130);
    EXPECT_EQ(told->joint, "Root");  // the first in the row
    EXPECT_EQ(told->where.line, kFirstRowLine + 130);
    EXPECT_EQ(told->where.column, 12);
    EXPECT_NE(told->message.find("Root.Xrotation"), std::string::npos) << told->message;
    EXPECT_NE(told->message.find("2 frames"), std::string::npos) << told->message;
    EXPECT_EQ(capture.clip.frame_count(), 300);
  }
}

// 12345678.5 degrees are 34293 turns and 198.5 degrees.
TEST(FarValues, TheRotationIsReadLessItsTurns) {
  const Capture far = read_ok(damaged_rows(3, {{1, 8, "12345678.5"}}));
  const Capture near = read_ok(damaged_rows(3, {{1, 8, "198.5"}}));
  for (std::size_t i = 0; i < near.clip.positions.size(); ++i) {
    EXPECT_LT((far.clip.positions[i] - near.clip.positions[i]).norm(), 1e-6f) << i;
  }
}

TEST(FarValues, APositionBeyondSenseIsToldOnceWithItsPlace) {
  const Capture capture =
      read_ok(damaged_rows(100, {{40, 1, "-2.5e5"}, {41, 0, "1e6"}, {90, 2, "1e6"}}));
  EXPECT_EQ(warnings(capture), 1);
  const Diagnostic* told = find(capture.diagnostics, "bvh-far-position");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->joint, "Root");
  EXPECT_EQ(told->frame, 40);
  EXPECT_EQ(told->where.line, kFirstRowLine + 40);
  EXPECT_EQ(told->where.column, 4);
  EXPECT_NE(told->message.find("Root.Yposition is -250000"), std::string::npos) << told->message;
  EXPECT_NE(told->message.find("3 frames"), std::string::npos) << told->message;
  // Floats from 131072 on are 2^-6 apart.
  EXPECT_NE(told->message.find("15.6 mm"), std::string::npos) << told->message;
}

TEST(FarValues, WhatMayBeIsNotToldOf) {
  // A dancer's 2,700 turns, far from the origin of a town; a jump of 300 m.
  std::vector<Damage> town = {{7, 3, "972000"}, {8, 4, "-999999"}};
  for (int row = 0; row < 50; ++row) town.push_back({row, 0, "29000"});
  EXPECT_EQ(warnings(read_ok(damaged_rows(50, town))), 0);
  const Capture capture = read_ok(damaged_rows(50, {{9, 0, "300"}}));
  EXPECT_EQ(warnings(capture), 0);
}

// Six frames a kilometre away, in a capture that is read as a stream otherwise.
TEST(FarValues, ARootAwayForSomeFramesIsReported) {
  std::vector<Damage> away;
  for (int row = 140; row < 146; ++row) away.push_back({row, 0, "1460"});
  const Capture capture = read_ok(damaged_rows(200, away));
  EXPECT_EQ(warnings(capture), 1);
  const Diagnostic* told = find(capture.diagnostics, "bvh-far-position");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->frame, 140);
  EXPECT_NE(told->message.find("for most of the time; 6 frames"), std::string::npos)
      << told->message;
}

TEST(FarValues, FarIsMeasuredByTheSkeleton) {
  // 30 km is much for an arm of 3 m, as 40 km would not be for one of 5 m.
  std::string large = damaged_rows(5, {{1, 0, "40000"}, {2, 0, "40000"}, {3, 0, "40000"}});
  EXPECT_EQ(warnings(read_ok(large)), 1);
  large.replace(large.find("OFFSET 2 0 0"), 12, "OFFSET 4 0 0");
  EXPECT_EQ(warnings(read_ok(large)), 0);
}

TEST(FarValues, StrictRefusesThem) {
  ReadOptions options = plain_options();
  options.strictness = Strictness::strict;
  const Error turned = read_error(damaged_rows(50, {{7, 3, "1e8"}}), options);
  EXPECT_EQ(turned.code, "bvh-far-rotation");
  EXPECT_EQ(turned.where.line, kFirstRowLine + 7);
  EXPECT_EQ(read_error(damaged_rows(50, {{7, 3, "4"}, {9, 2, "1e8"}}), options).code,
            "bvh-far-position");
}

TEST(FarValues, RadiansAreMeasuredInDegrees) {
  ReadOptions options = plain_options();
  options.angles = Angles::radians;
  // One says that the rows are degrees.
  EXPECT_EQ(warnings(read_ok(damaged_rows(9, {{3, 3, "17000"}}), options)), 1);
  EXPECT_EQ(warnings(read_ok(damaged_rows(9, {{3, 3, "18000"}}), options)), 2);
}

// Rows that are left out are no frames, and have no say.
TEST(FarValues, FaultyRowsHaveNone) {
  ReadOptions options = plain_options();
  options.strictness = Strictness::repair;
  const Capture capture = read_ok(damaged_rows(40, {{5, 3, "1e8"}, {6, 3, "oops"}}), options);
  const Diagnostic* told = find(capture.diagnostics, "bvh-far-rotation");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->frame, 5);
  EXPECT_NE(told->message.find("no other frame"), std::string::npos) << told->message;
}

// Only an OFFSET puts it there: no number of the row is to blame.
TEST(FarValues, ARootThatStandsFarAwayIsToldWithoutAChannel) {
  const Capture capture = read_ok(
      "HIERARCHY\nROOT Far\n{\nOFFSET 1e9 0 0\nCHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 0 1 "
      "0\n}\n}\n" +
      motion(2, "30\n60\n"));
  const Diagnostic* told = find(capture.diagnostics, "bvh-far-position");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->joint, "Far");
  EXPECT_EQ(told->frame, 0);
  EXPECT_EQ(told->message.find("Xrotation"), std::string::npos) << told->message;
}

// If this fails, a body whose positions are in metres and offsets in centimetres walks on the spot,
// silently, or one that is right is doubted.
TEST(PositionUnit, IsThatOfTheOffsets) {
  const auto warned = [](double scale, double bob) {
    std::string rows;
    for (int f = 0; f < 12; ++f) {
      const double height = scale * (95 + bob * std::sin(f));
      rows += "0 " + std::to_string(height) + " " + std::to_string(scale * f) + " 0 0 0 90 0 0\n";
    }
    std::string leg = kArm;
    leg.replace(leg.find("OFFSET 1 0 0"), 12, "OFFSET 0 -45 0");
    leg.replace(leg.find("OFFSET 2 0 0"), 12, "OFFSET -50 0 0");
    const Capture capture = read_ok(leg + motion(12, rows));
    return find(capture.diagnostics, "bvh-position-unit") != nullptr;
  };
  EXPECT_FALSE(warned(0, 2)) << "in place";
  EXPECT_FALSE(warned(1, 2));
  EXPECT_TRUE(warned(0.01, 2));
  EXPECT_TRUE(warned(100, 2));
  EXPECT_FALSE(warned(0.01, 200)) << "sways about the origin";
}

}  // namespace
}  // namespace krok::bvh
