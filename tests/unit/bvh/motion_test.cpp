// If these fail, frames come in turned or placed wrongly, damaged rows pass unnoticed, or whole
// ones are lost.

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "formats/bvh/motion_rows.h"

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

std::string row_of(int value) {
  std::string row;
  for (int i = 0; i < 9; ++i) row += std::to_string(value) + (i == 8 ? "\n" : " ");
  return row;
}

std::string rows_of(int frames) {
  std::string rows;
  for (int frame = 0; frame < frames; ++frame) rows += row_of(frame);
  return rows;
}

TEST(Motion, RotationsApplyInTheOrderOfTheChannels) {
  // A quarter turn about z, then (in the turned frame) about x: the hand's +x points to +y.
  const Capture capture = read_ok(kArm + motion(1, "5 6 7 90 90 0 0 0 90\n"));
  const auto positions = capture.clip.frame_positions(0);
  EXPECT_TRUE(positions[0].isApprox(Vec3f(5, 6, 7)));
  EXPECT_TRUE(positions[1].isApprox(Vec3f(5, 7, 7), 1e-6f)) << positions[1].transpose();
  // Ry takes x to -z, the root's Rx takes that to y, its Rz that to -x.
  const Vec3f direction = (positions[2] - positions[1]) / 2.0f;
  EXPECT_TRUE(direction.isApprox(Vec3f(-1, 0, 0), 1e-5f)) << direction.transpose();
}

// strtod rounds correctly too.
TEST(Motion, NumbersAreTheNearestDoublesToWhatIsPrinted) {
  for (const char* word :
       {"0", "-0", "-0.0", "12.345678", "-179.999999", "000.1", "1e-3", "+2.5", ".5", "-.25", "5.",
        "123456789012345", "1234567890123456", "0.30000000000000004", "2.2250738585072014e-308",
        "99999999999999999999999", "0.000000000000001", "9007199254740993", "3.14159265358979"}) {
    for (const char* after : {"\n", " ", ""}) {
      const std::string text = std::string(word) + after;
      double value = 1;
      ASSERT_EQ(parse_row(text, 0, {&value, 1}), std::strlen(word)) << word;
      const double expected = std::strtod(word, nullptr);
      EXPECT_EQ(std::memcmp(&value, &expected, sizeof value), 0) << word;
    }
  }
  for (const char* word : {"-", ".", "", "-.", "1.2.3", "1,5", "--1", "+-1", "0x10", "1e999", "nan",
                           "12345678901234567890x", "1.x"}) {
    for (const char* after : {"\n", " 1 ", ""}) {
      double value = 1;
      const std::string text = std::string(word) + after;
      if (std::string(word).empty() && *after == ' ') continue;
      EXPECT_EQ(parse_row(text, 0, {&value, 1}), RowIndex::kFaulty) << text;
    }
  }
}

TEST(Motion, EachJointKeepsItsOwnOrderAndNumberOfChannels) {
  const std::string text =
      "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 4 Yrotation Xposition Xrotation Yrotation\n"
      "JOINT b\n{\nOFFSET 0 1 0\nCHANNELS 1 Zrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n}\n" +
      motion(1, "30 2 90 60 90\n");
  const Clip clip = read_ok(text).clip;
  const Quat expected = axis_rotation(Axis::y, kPi / 6) * axis_rotation(Axis::x, kPi / 2) *
                        axis_rotation(Axis::y, kPi / 3);
  EXPECT_TRUE(clip.positions[0].isApprox(Vec3f(2, 0, 0)));
  EXPECT_LT(clip.orientations[0].cast<double>().angularDistance(expected), 1e-6);
  EXPECT_TRUE(
      clip.positions[1].isApprox((expected * Vec3::UnitY()).cast<float>() + Vec3f(2, 0, 0), 1e-6f));
  const Quat second = expected * axis_rotation(Axis::z, kPi / 2);
  EXPECT_TRUE((clip.positions[2] - clip.positions[1])
                  .isApprox((second * Vec3::UnitY()).cast<float>(), 1e-5f));
}

TEST(Motion, ConversionTurnsAndScalesWholeActor) {
  const std::string text = kArm + motion(1, "100 200 300 20 30 40 50 60 70\n");
  ReadOptions options = plain_options();
  const Clip plain = read_ok(text, options).clip;
  options.unit = Unit{0.01, "cm"};
  options.up = Direction::plus_z;
  options.forward = Direction::minus_y;
  const Capture capture = read_ok(text, options);
  const Quat turn = *rotation_to_krok(Direction::plus_z, Direction::minus_y);
  for (std::size_t j = 0; j < 3; ++j) {
    const Vec3 expected = turn * (plain.positions[j].cast<double>() * 0.01);
    EXPECT_LT((capture.clip.positions[j].cast<double>() - expected).norm(), 1e-6);
    const Quat orientation = turn * plain.orientations[j].cast<double>() * turn.conjugate();
    EXPECT_LT(capture.clip.orientations[j].cast<double>().angularDistance(orientation), 1e-6);
    const Vec3 reference = turn * (plain.skeleton.reference[j].position * 0.01);
    EXPECT_LT((capture.clip.skeleton.reference[j].position - reference).norm(), 1e-12);
    EXPECT_EQ(capture.clip.skeleton.reference[j].orientation.coeffs(), Quat::Identity().coeffs());
  }
  EXPECT_EQ(capture.clip.provenance.conversions.size(), 2u);
}

TEST(Motion, PositionsReplaceOrAddToOffsets) {
  const std::string text =
      "HIERARCHY\nROOT a\n{\nOFFSET 1 2 3\nCHANNELS 2 Xposition Zposition\n}\n" +
      motion(1, "10 20\n");
  ReadOptions options = plain_options();
  EXPECT_EQ(read_ok(text, options).clip.positions[0], Vec3f(10, 2, 20));
  options.positions = Positions::additive;
  EXPECT_EQ(read_ok(text, options).clip.positions[0], Vec3f(11, 2, 23));
}

TEST(Motion, TheReadingOfPositionsIsWorkedOut) {
  const auto choice = [](const std::string& rows, int frames) {
    ReadOptions options = plain_options();
    options.positions = Positions::automatic;
    return read_ok(
               "HIERARCHY\nROOT a\n{\nOFFSET 0 90 0\n"
               "CHANNELS 3 Xposition Yposition Zposition\n"
               "JOINT b\n{\nOFFSET 0 10 0\n}\n}\n" +
                   motion(frames, rows),
               options)
        .positions;
  };
  EXPECT_EQ(choice("300 91 0\n310 89 5\n", 2).choice, "absolute");
  EXPECT_EQ(choice("300 1 0\n310 -1 5\n", 2).choice, "additive");
  EXPECT_EQ(choice("300 45 0\n310 44 5\n", 2).confidence, Confidence::guess);
  EXPECT_EQ(choice("", 0).choice, "absolute");
}

TEST(Motion, TheGroundTellsWhetherTheRootsPositionsReplaceItsOffset) {
  // A pole of 1 m whose root hangs 90 above its foot; the OFFSET lies far to the side as well, as
  // where an exporter puts the root's place in some frame of another take there.
  const auto choice = [](const std::string& offset, const std::string& row) {
    ReadOptions options = plain_options();
    options.positions = Positions::automatic;
    return read_ok("HIERARCHY\nROOT a\n{\nOFFSET " + offset +
                       "\nCHANNELS 3 Xposition Yposition Zposition\n"
                       "JOINT b\n{\nOFFSET 0 10 0\n}\nJOINT c\n{\nOFFSET 0 -90 0\n}\n}\n" +
                       motion(1, row),
                   options)
        .positions;
  };
  for (const std::string row : {"-1143 91 300\n", "193 93 495\n"}) {
    EXPECT_EQ(choice("193 91 495", row).choice, "absolute") << row;
    EXPECT_EQ(choice("193 91 495", row).confidence, Confidence::likely) << row;
  }
  EXPECT_EQ(choice("193 91 495", "-1143 1 300\n").choice, "additive");
  EXPECT_EQ(choice("0 -22 0", "0 91 0\n").choice, "absolute");
  EXPECT_EQ(choice("0 22 0", "0 69 0\n").choice, "additive");
  // Far above the ground in both readings: as most files have it, with a warning.
  EXPECT_EQ(choice("0 -20 0", "0 200 0\n").choice, "absolute");
  EXPECT_EQ(choice("0 -20 0", "0 200 0\n").confidence, Confidence::guess);
}

// Takes of one rig whose OFFSET is horizontal, far above the ground in both readings. If the values
// along the OFFSET decided, where a take starts would, and takes would be shifted against others.
TEST(Motion, TheOffsetsHorizontalPartSaysNothingOfPositions) {
  const auto choice = [](const std::string& offset, const std::string& row) {
    ReadOptions options = plain_options();
    options.positions = Positions::automatic;
    return read_ok("HIERARCHY\nROOT a\n{\nOFFSET " + offset +
                       "\nCHANNELS 3 Xposition Yposition Zposition\n"
                       "JOINT b\n{\nOFFSET 0 10 0\n}\nJOINT c\n{\nOFFSET 0 -90 0\n}\n}\n" +
                       motion(1, row),
                   options)
        .positions;
  };
  for (const std::string row : {"-24 110 126\n", "-30 110 8\n", "0 110 0\n"}) {
    const Choice horizontal = choice("0 0 97", row);
    EXPECT_EQ(horizontal.choice, "absolute") << row;
    EXPECT_EQ(horizontal.confidence, Confidence::likely) << row;
    EXPECT_NE(horizontal.reason.find("horizontal"), std::string::npos) << horizontal.reason;
  }
  for (const std::string row : {"0 15 900\n", "0 15 0\n"}) {
    EXPECT_EQ(choice("0 90 900", row).choice, "additive") << row;
  }
}

// A person who leaps, in a file whose reference pose has the legs folded up: its up axis is a
// guess, but the same in both readings, in one of which it would leap under the ground.
TEST(Motion, TheGroundTellsItWhereUpIsAGuessThatDoesNotDependOnIt) {
  const auto joint = [](const char* name, const char* offset, const std::string& below) {
    return std::string("JOINT ") + name + "\n{\nOFFSET " + offset + "\nCHANNELS 1 Xrotation\n" +
           below + "}\n";
  };
  const auto leg = [&](const std::string& side, const char* offset) {
    return joint(
        (side + "UpLeg").c_str(), offset,
        joint((side + "Leg").c_str(), "0 50 0",
              joint((side + "Foot").c_str(), "0 50 0", "End Site\n{\nOFFSET 0 4 12\n}\n")));
  };
  const std::string text =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 105 0\n"
      "CHANNELS 4 Xposition Yposition Zposition Xrotation\n" +
      joint("Spine", "0 20 0", joint("Head", "0 40 0", "End Site\n{\nOFFSET 0 20 0\n}\n")) +
      leg("Left", "10 0 0") + leg("Right", "-10 0 0") + "}\n" +
      motion(4,
             "0 3 0 0 0 0 180 0 0 180 0 0\n0 4 10 0 0 0 180 0 0 180 0 0\n"
             "0 5 20 0 0 0 180 0 0 180 0 0\n0 45 50 0 0 0 180 0 0 180 0 0\n");
  ReadOptions options = plain_options();
  options.positions = Positions::automatic;
  options.up = std::nullopt;
  const Capture capture = read_ok(text, options);
  EXPECT_EQ(capture.conventions.up_confidence, Confidence::guess);
  EXPECT_EQ(capture.conventions.up, Direction::plus_y);
  EXPECT_EQ(capture.positions.choice, "additive") << capture.positions.reason;
}

TEST(Motion, HipsUnderARootThatOnlyPlacesThemTravelAsARootDoes) {
  // The OFFSET is where the hips stood in another take, the root turns their height from x to y.
  const auto choice = [](const std::string& row) {
    ReadOptions options = plain_options();
    options.positions = Positions::automatic;
    return read_ok(
               "HIERARCHY\nROOT place\n{\nOFFSET 0 0 0\nCHANNELS 1 Zrotation\n"
               "JOINT hips\n{\nOFFSET 94 1 -452\n"
               "CHANNELS 3 Xposition Yposition Zposition\n"
               "JOINT b\n{\nOFFSET 10 0 0\n}\nJOINT c\n{\nOFFSET -90 0 0\n}\n}\n}\n" +
                   motion(1, row),
               options)
        .positions;
  };
  EXPECT_EQ(choice("90 93 0 -9\n").choice, "absolute");
  EXPECT_EQ(choice("90 93 0 -9\n").confidence, Confidence::likely);
  EXPECT_EQ(choice("90 1 0 -9\n").choice, "additive");
}

TEST(Motion, RowsMayGoOverLinesAndExponentsAndSignsAreNumbers) {
  const Clip expected = read_ok(kArm + motion(2, "1 2 3 4 5 6 7 8 9\n9 8 7 6 5 4 3 2 1\n")).clip;
  for (const std::string rows :
       {"1 2 3 4 5\n6 7 8 9\n9 8 7 6 5\n4 3 2 1", "1 2 3 4 5 6 7 8 9 9 8 7 6 5 4 3 2 1\n",
        "1\n2\n3\n4\n5\n6\n7\n8\n9\n9\n8\n7\n6\n5\n4\n3\n2\n1\n",
        "1 2 3 4\n5 6 7 8\n9 9 8 7\n6 5 4 3\n2 1",
        "\t+1 2.0 30e-1 .4e1 5. 6 7 8 9\n\n\n9 8 7 6 5 4 3 2 1 \n\n"}) {
    const Capture capture = read_ok(kArm + motion(2, rows), with(Strictness::strict));
    EXPECT_EQ(capture.clip.positions, expected.positions) << rows;
  }
}

TEST(Motion, HeadersMayBeSpacedInAnyWay) {
  for (const std::string header :
       {"MOTION\nFrames:\t1\nFrame Time:\t0.1\n", "MOTION\nFRAMES: 1\nFRAME TIME: 1e-1\n",
        "motion\n\nframes:1\n\nFrameTime:0.1\n", "MOTION\nFrames : 1\nFrame  Time : 0.1\n",
        "MOTION Frame Time: .1 Frames: 1\n"}) {
    const Capture capture = read_ok(kArm + header + row_of(1));
    EXPECT_EQ(capture.clip.frame_count(), 1) << header;
    EXPECT_EQ(capture.clip.rate, 10.0) << header;
  }
}

TEST(Motion, NoFramesAndOneFrame) {
  EXPECT_EQ(read_ok(kArm + motion(0, "")).clip.frame_count(), 0);
  EXPECT_EQ(read_ok(kArm + motion(1, row_of(3))).clip.frame_count(), 1);
  const Capture without_channels =
      read_ok("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\nMOTION\nFrames: 3\nFrame Time: 1\n");
  EXPECT_EQ(without_channels.clip.frame_count(), 0);
  EXPECT_NE(find(without_channels.diagnostics, "bvh-frame-count"), nullptr);
}

TEST(Motion, TextAfterTheDataIsLeftOut) {
  for (const std::string tail : {"made by hand\n", "KEYS 1 5 9\n1 2\n", "1 2 3\n", "# end\n"}) {
    const Capture capture = read_ok(kArm + motion(3, rows_of(3) + "\n" + tail));
    EXPECT_EQ(capture.clip.frame_count(), 3);
    EXPECT_NE(find(capture.diagnostics, "bvh-text-after"), nullptr) << tail;
  }
}

TEST(Motion, AShortRowIsLeftOutOrRefusedOrFilled) {
  const std::string text =
      kArm + motion(4, row_of(0) + "1 1 1 1 1 1 1 1\n" + row_of(2) + row_of(3));
  const Capture normal = read_ok(text);
  EXPECT_EQ(normal.clip.frame_count(), 3);
  const Diagnostic* warning = find(normal.diagnostics, "bvh-channel-count");
  ASSERT_NE(warning, nullptr);
  EXPECT_EQ(warning->where.line, 20);
  EXPECT_EQ(warning->where.column, 16);
  EXPECT_EQ(warning->frame, 1);
  EXPECT_NE(warning->message.find("8 values, expected 9 (missing: Elbow.Yrotation)"),
            std::string::npos);

  EXPECT_EQ(read_error(text, with(Strictness::strict)).code, "bvh-channel-count");

  const Capture repaired = read_ok(text, with(Strictness::repair));
  ASSERT_EQ(repaired.clip.frame_count(), 4);
  EXPECT_EQ(repaired.repairs.size(), 1u);
  const Clip whole = read_ok(kArm + motion(4, rows_of(4))).clip;
  EXPECT_LT((repaired.clip.frame_positions(1)[2] - whole.frame_positions(1)[2]).norm(), 5e-3f);
  EXPECT_EQ(repaired.clip.frame_positions(3)[2], whole.frame_positions(3)[2]);
}

TEST(Motion, ALongRowIsToldWhereItIsTooLong) {
  const std::string text = kArm + motion(3, row_of(0) + "1 1 1 1 1 1 1 1 1 77\n" + row_of(2));
  const Error error = read_error(text, with(Strictness::strict));
  EXPECT_EQ(error.code, "bvh-channel-count");
  EXPECT_EQ(error.where.line, 20);
  EXPECT_EQ(error.where.column, 19);
  EXPECT_EQ(read_ok(text).clip.frame_count(), 2);
}

TEST(Motion, NumbersThatAreNoneAreErrorsUnlessRepaired) {
  for (const std::string bad : {"12.3abc", "nan", "-inf", "1e999", "1,5", "--3", "0x10", "."}) {
    const std::string text =
        kArm + motion(3, row_of(0) + "1 1 1 " + bad + " 1 1 1 1 1\n" + row_of(2));
    for (const Strictness strictness : {Strictness::normal, Strictness::strict}) {
      const Error error = read_error(text, with(strictness));
      EXPECT_EQ(error.code, "bvh-number") << bad;
      EXPECT_EQ(error.where.line, 20);
      EXPECT_EQ(error.where.column, 7);
      EXPECT_NE(error.message.find("'" + bad + "'"), std::string::npos);
      EXPECT_NE(error.message.find("Root.Zrotation"), std::string::npos);
    }
    const Capture repaired = read_ok(text, with(Strictness::repair));
    EXPECT_EQ(repaired.clip.frame_count(), 3) << bad;
    EXPECT_EQ(repaired.repairs.size(), 1u);
    EXPECT_TRUE(check(repaired.clip).ok());
  }
}

TEST(Motion, FaultyFramesAtTheEndsAreLeftOutByRepair) {
  const std::string bad = "nan 1 1 1 1 1 1 1 1\n";
  const Capture capture =
      read_ok(kArm + motion(4, bad + row_of(1) + row_of(2) + bad), with(Strictness::repair));
  EXPECT_EQ(capture.clip.frame_count(), 2);
  EXPECT_EQ(capture.repairs.size(), 2u);
}

TEST(Motion, ACountThatDisagreesIsAWarning) {
  for (const int announced : {2, 4}) {
    const std::string text = kArm + motion(announced, rows_of(3));
    const Capture capture = read_ok(text);
    EXPECT_EQ(capture.clip.frame_count(), 3);
    const Diagnostic* warning = find(capture.diagnostics, "bvh-frame-count");
    ASSERT_NE(warning, nullptr);
    EXPECT_EQ(warning->where.line, 17);
    EXPECT_EQ(read_error(text, with(Strictness::strict)).code, "bvh-frame-count");
    EXPECT_EQ(read_ok(text, with(Strictness::repair)).repairs.size(), 1u);
  }
  // None at all is no count to get along with.
  EXPECT_EQ(read_error(kArm + motion(4, "")).code, "bvh-frame-count");
}

TEST(Motion, AFrameWhoseLastNumberMayBeCutIsLeftOut) {
  const std::string text = kArm + motion(5, row_of(0) + row_of(1) + "2 2 2 2 2 2 2 2 2");
  const Capture capture = read_ok(text);
  EXPECT_EQ(capture.clip.frame_count(), 2);
  EXPECT_NE(find(capture.diagnostics, "bvh-cut"), nullptr);
  // With the announced number of frames it is a file without a line end, no more.
  EXPECT_EQ(read_ok(kArm + motion(3, row_of(0) + row_of(1) + "2 2 2 2 2 2 2 2 2"),
                    with(Strictness::strict))
                .clip.frame_count(),
            3);
}

TEST(Motion, CountsBeyondAllMeasureTakeNoMemory) {
  EXPECT_EQ(read_error(kArm + motion(2000000000, "")).code, "bvh-frame-count");
  const Capture capture =
      read_ok(kArm + "MOTION\nFrames: 9223372036854775807\nFrame Time: 1\n" + row_of(1));
  EXPECT_EQ(capture.clip.frame_count(), 1);
}

TEST(Motion, AFileOutOfProportionIsRefused) {
  // Many joints without channels beside one channel: each row of two bytes makes a large frame.
  std::string text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n";
  for (int i = 0; i < 5000; ++i) text += "End Site{OFFSET 0 0 1}\n";
  text += "}\nMOTION\nFrames: 50000\nFrame Time: 1\n";
  for (int i = 0; i < 50000; ++i) text += "1\n";
  EXPECT_EQ(read_error(text).code, "bvh-limit");
}

TEST(Motion, PositionsThatOverflowAreRefused) {
  EXPECT_EQ(read_error(kArm + motion(1, "1e300 0 0 0 0 0 0 0 0\n")).code, "bvh-number");
}

TEST(Motion, TheResultDoesNotDependOnTheThreads) {
  const std::string text = kArm + motion(1000, rows_of(1000));
  ReadOptions options = plain_options();
  options.jobs = 1;
  const Clip one = read_ok(text, options).clip;
  options.jobs = 4;
  const Clip four = read_ok(text, options).clip;
  EXPECT_EQ(one.positions, four.positions);
  for (std::size_t i = 0; i < one.orientations.size(); ++i) {
    ASSERT_EQ(one.orientations[i].coeffs(), four.orientations[i].coeffs());
  }
}

TEST(Motion, TheFirstFrameIsLeftOutWhereAsked) {
  ReadOptions options = plain_options();
  options.rest_frame = RestFrame::drop;
  const Capture capture = read_ok(kArm + motion(3, rows_of(3)), options);
  EXPECT_EQ(capture.clip.frame_count(), 2);
  EXPECT_EQ(capture.clip.positions[0], Vec3f(1, 1, 1));
  EXPECT_TRUE(capture.rest_frame_dropped);
  EXPECT_EQ(read_ok(kArm + motion(0, ""), options).clip.frame_count(), 0);
}

TEST(Motion, ARestFrameBeforeTheMotionIsRecognised) {
  std::string rows = "0 0 0 0 0 0 0 0 0\n";
  for (int i = 0; i < 9; ++i) rows += "0 0 0 0 0 0 80 " + std::to_string(i) + " 0\n";
  ReadOptions options = plain_options();
  const Capture kept = read_ok(kArm + motion(10, rows), options);
  EXPECT_TRUE(kept.rest_frame_found);
  EXPECT_EQ(kept.clip.frame_count(), 10);
  options.rest_frame = RestFrame::automatic;
  EXPECT_EQ(read_ok(kArm + motion(10, rows), options).clip.frame_count(), 9);
  // A motion that begins unturned and goes on evenly has no such frame.
  std::string even;
  for (int i = 0; i < 10; ++i) even += "0 0 0 0 0 0 " + std::to_string(20 * i) + " 0 0\n";
  EXPECT_EQ(read_ok(kArm + motion(10, even), options).clip.frame_count(), 10);
}

TEST(Motion, AnAxisGivenAlongTheWorkedOutOneIsSettled) {
  ReadOptions options;
  options.up = Direction::plus_z;
  const Capture capture = read_ok(kArm + motion(1, row_of(0)), options);
  EXPECT_EQ(capture.conventions.up, Direction::plus_z);
  EXPECT_TRUE(check(capture.clip).ok());
}

TEST(Motion, NumbersBeyondAFloatAreFaultsWithTheirPlace) {
  const std::string good = "0 0 0 0 0 0 0 0 0\n";
  const std::string text = kArm + motion(3, good + "0 1e39 0 0 0 0 0 0 0\n" + good);
  ReadOptions options = plain_options();
  options.unit = Unit{0.01, "cm"};
  const Error error = read_error(text, options);
  EXPECT_EQ(error.code, "bvh-number");
  EXPECT_NE(error.message.find("too large"), std::string::npos) << error.message;
  EXPECT_EQ(error.where.line, 20);
  EXPECT_EQ(error.where.column, 3);
  options.strictness = Strictness::repair;
  const Capture repaired = read_ok(text, options);
  EXPECT_EQ(repaired.clip.frame_count(), 3);
  EXPECT_EQ(repaired.repairs.size(), 1u);
  // Each number fits, but not what becomes of them.
  options = plain_options();
  options.unit = Unit{1000, "1000m"};
  const Error sum = read_error(kArm + motion(2, good + "0 3e38 0 0 0 0 0 0 0\n"), options);
  EXPECT_EQ(sum.code, "bvh-number");
  EXPECT_EQ(sum.where.line, 20);
}

}  // namespace
}  // namespace krok::bvh
