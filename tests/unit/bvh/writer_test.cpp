// If these fail, exported captures differ from the motion they were made of, or other programs
// cannot read them.

#include <unistd.h>

#include <cmath>

#include "math/quaternion.h"
#include "support/human_skeleton.h"
#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

Capture read_back(const std::string& text, double unit_metres = 0.01) {
  ReadOptions options = plain_options();
  options.unit = Unit{unit_metres, "given"};
  options.strictness = Strictness::strict;
  return read_ok(text, options);
}

void expect_same_motion(const Clip& a, const Clip& b, float tolerance = 2e-6f) {
  ASSERT_EQ(a.frame_count(), b.frame_count());
  ASSERT_EQ(a.joint_count(), b.joint_count());
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    ASSERT_LT((a.positions[i] - b.positions[i]).norm(), tolerance) << i;
  }
}

Clip arm_clip(int frames) {
  std::string rows;
  for (int i = 0; i < frames; ++i) {
    for (int c = 0; c < 9; ++c) rows += std::to_string(0.37 * i + c) + " ";
    rows += "\n";
  }
  return read_ok(kArm + motion(frames, rows)).clip;
}

TEST(BvhWriter, WritesTheFormsThatReadersExpect) {
  const std::string text = written(arm_clip(2));
  EXPECT_TRUE(text.starts_with(
      "HIERARCHY\nROOT Root\n{\n\tOFFSET 0.000000 0.000000 0.000000\n"
      "\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
      "\tJOINT Elbow\n\t{\n\t\tOFFSET 100.000000 0.000000 0.000000\n"
      "\t\tCHANNELS 3 Zrotation Xrotation Yrotation\n\t\tEnd Site\n\t\t{\n"
      "\t\t\tOFFSET 200.000000 0.000000 0.000000\n\t\t}\n\t}\n}\nMOTION\nFrames: 2\n"
      "Frame Time: 0.1"))
      << text;
}

TEST(BvhWriter, ReadsBackInEveryOrderAndUnit) {
  const Clip clip = arm_clip(20);
  for (const EulerOrder order :
       {EulerOrder{Axis::x, Axis::y, Axis::z}, EulerOrder{Axis::x, Axis::z, Axis::y},
        EulerOrder{Axis::y, Axis::x, Axis::z}, EulerOrder{Axis::y, Axis::z, Axis::x},
        EulerOrder{Axis::z, Axis::x, Axis::y}, EulerOrder{Axis::z, Axis::y, Axis::x}}) {
    for (const double unit : {1.0, 0.01, 0.001, 0.0254}) {
      WriteOptions options;
      options.order = order;
      options.unit_metres = unit;
      const Capture back = read_back(written(clip, options), unit);
      expect_same_motion(clip, back.clip, 5e-6f);
      EXPECT_EQ(difference_in_structure(clip.skeleton, back.clip.skeleton), "");
      EXPECT_EQ(clip.skeleton.end_sites, back.clip.skeleton.end_sites);
    }
  }
}

TEST(BvhWriter, AnglesHaveNoJumps) {
  // An arm that turns three times round.
  Clip clip = arm_clip(1);
  clip.resize(100);
  std::vector<Transform> pose(3);
  for (int frame = 0; frame < 100; ++frame) {
    clip.get_pose(0, pose);
    pose[0].orientation = axis_rotation(Axis::z, 6.0 * kPi * frame / 99.0);
    clip.set_pose(frame, pose);
  }
  const std::string text = written(clip);
  std::istringstream rows(text.substr(text.find("Frame Time")));
  std::string line;
  std::getline(rows, line);
  double previous = 0;
  while (std::getline(rows, line)) {
    std::istringstream values(line);
    double x, y, z, angle;
    values >> x >> y >> z >> angle;
    EXPECT_LT(std::abs(angle - previous), 15.0);
    previous = angle;
  }
  EXPECT_NEAR(previous, 1080.0, 1e-3);
}

TEST(BvhWriter, ReferenceOrientationsAreFoldedIntoTheMotion) {
  Clip clip = arm_clip(10);
  const Clip plain = clip;
  // The same motion, its joint frames turned in the reference pose and in each frame alike.
  const std::vector<Quat> turns = {axis_rotation(Axis::x, 0.4), axis_rotation(Axis::y, 2.0),
                                   axis_rotation(Axis::z, -1.0)};
  for (std::size_t j = 0; j < 3; ++j) clip.skeleton.reference[j].orientation = turns[j];
  for (std::size_t i = 0; i < clip.orientations.size(); ++i) {
    clip.orientations[i] = (clip.orientations[i].cast<double>() * turns[i % 3]).cast<float>();
  }
  const Capture back = read_back(written(clip));
  expect_same_motion(plain, back.clip);
  for (std::size_t i = 0; i < clip.orientations.size(); ++i) {
    if (i % 3 == 2) continue;  // an End Site has no turn of its own
    EXPECT_LT(angle_between(plain.orientations[i].cast<double>(),
                            back.clip.orientations[i].cast<double>()),
              2e-6);
  }
}

TEST(BvhWriter, TranslationsThatVaryGetPositionChannels) {
  Clip clip = arm_clip(5);
  clip.positions[3 * 3 + 1] += Vec3f(0.01f, 0, 0);  // the elbow of frame 3
  clip.positions[3 * 3 + 2] += Vec3f(0.01f, 0, 0);
  const std::string text = written(clip);
  const std::size_t first = text.find("CHANNELS 6");
  EXPECT_NE(text.find("CHANNELS 6", first + 1), std::string::npos);
  expect_same_motion(clip, read_back(text).clip);
  // An end site that moves becomes a joint, or its motion would be lost.
  clip.positions[4 * 3 + 2] += Vec3f(0, 0.1f, 0);
  const std::string moved = written(clip);
  EXPECT_EQ(moved.find("End Site"), std::string::npos);
  expect_same_motion(clip, read_back(moved).clip);
}

TEST(BvhWriter, LeavesThatAreNoEndSitesStayJoints) {
  Clip clip = arm_clip(3);
  clip.skeleton.end_sites[2] = 0;
  clip.skeleton.names[2] = "Hand";
  const Capture back = read_back(written(clip));
  EXPECT_EQ(back.clip.skeleton.names, clip.skeleton.names);
  EXPECT_EQ(back.clip.skeleton.end_sites, clip.skeleton.end_sites);
  expect_same_motion(clip, back.clip);
}

TEST(BvhWriter, JointsInAnotherOrderAreWrittenDepthFirst) {
  Clip clip;
  clip.skeleton.add("a", -1, {});
  clip.skeleton.add("b", 0, {Vec3(1, 0, 0), Quat::Identity()});
  clip.skeleton.add("c", 0, {Vec3(-1, 0, 0), Quat::Identity()});
  clip.skeleton.add("b1", 1, {Vec3(2, 0, 0), Quat::Identity()});
  clip.resize(1);
  clip.set_pose(0, clip.skeleton.reference);
  const Clip back = read_back(written(clip)).clip;
  EXPECT_EQ(back.skeleton.names, (std::vector<std::string>{"a", "b", "b1", "c"}));
  EXPECT_EQ(back.positions[2], Vec3f(2, 0, 0));
  EXPECT_EQ(back.positions[3], Vec3f(-1, 0, 0));
}

TEST(BvhWriter, NamesSurvive) {
  Clip clip = arm_clip(1);
  clip.skeleton.names = {"Left Arm", "a{b\n", "x"};
  EXPECT_EQ(read_back(written(clip)).clip.skeleton.names,
            (std::vector<std::string>{"Left Arm", "a_b", "a_b_end"}));
  WriteOptions options;
  options.space_in_names = "_";
  clip.skeleton.names = {"Left Arm", "Left_Arm", "x"};
  EXPECT_EQ(read_back(written(clip, options)).clip.skeleton.names[1], "Left_Arm_2");
}

TEST(BvhWriter, RootOffsetIsZeroUnlessAskedFor) {
  Clip clip = arm_clip(2);
  for (Transform& joint : clip.skeleton.reference) joint.position += Vec3(0, 1, 0);
  EXPECT_NE(written(clip).find("OFFSET 0.000000 0.000000 0.000000"), std::string::npos);
  WriteOptions options;
  options.root_offset = true;
  const Capture capture = read_back(written(clip, options));
  EXPECT_EQ(capture.positions.choice, "absolute");
  EXPECT_EQ(capture.positions.confidence, Confidence::certain);
  const Clip back = capture.clip;
  EXPECT_TRUE(back.skeleton.reference[0].position.isApprox(Vec3(0, 1, 0)));
  expect_same_motion(clip, back);
}

TEST(BvhWriter, RatesReadBackExactly) {
  Clip clip = arm_clip(2);
  for (const double rate :
       {24.0, 25.0, 30.0, 60.0, 120.0, 240.0, 30.0 / 1.001, 17.3, 1000.0, 1.0}) {
    clip.rate = rate;
    EXPECT_DOUBLE_EQ(read_back(written(clip)).clip.rate, rate);
  }
}

// The unit comes back although BVH has no place for it, whatever size the skeleton is; blanks that
// an editor strips leave a file that is read as before.
TEST(BvhWriter, TheUnitIsMarked) {
  Clip clip = arm_clip(2);  // an arm of 3 m that lies along x and does not show axes
  ReadOptions upright;
  upright.up = Direction::plus_y;
  upright.forward = Direction::plus_z;
  for (const char* unit : {"m", "dm", "cm", "mm", "in", "ft", "cmu"}) {
    WriteOptions options;
    options.unit_metres = parse_unit(unit)->metres;
    std::string text = written(clip, options);
    const Capture back = read_ok(text, upright);
    EXPECT_EQ(back.conventions.unit.name, unit);
    EXPECT_EQ(back.conventions.unit_confidence, Confidence::certain);
    EXPECT_EQ(back.rate.confidence, Confidence::certain);
    expect_same_motion(clip, back.clip, 1e-5f);
    const std::size_t time = text.find("Frame Time");
    const std::size_t blanks = text.find_first_of(" \t", text.find(' ', text.find(':', time)) + 1);
    text.erase(blanks, text.find('\n', time) - blanks);
    EXPECT_NE(read_ok(text, upright).conventions.unit_confidence, Confidence::certain);
    ReadOptions given = upright;
    given.unit = Unit{0.5, "given"};
    EXPECT_EQ(read_ok(written(clip, options), given).conventions.unit.metres, 0.5);
  }
}

// Would fail if the way back detected axes: a body whose reference pose faces aside or lies on its
// back came back turned.
TEST(BvhWriter, AxesComeBackWhateverTheReferencePose) {
  for (const Vec3& turn : {Vec3(0, kPi / 2, 0), Vec3(0, 0.8, 0), Vec3(-kPi / 2, 0, 0)}) {
    Clip clip;
    clip.skeleton = test::human_skeleton();
    const Quat turned = from_rotation_vector(turn);
    for (Transform& joint : clip.skeleton.reference) joint.position = turned * joint.position;
    clip.resize(3);
    for (int f = 0; f < 3; ++f) clip.set_pose(f, clip.skeleton.reference);
    expect_same_motion(clip, read_ok(written(clip), ReadOptions()).clip, 1e-5f);
  }
}

TEST(BvhWriter, NoFramesAndOneJoint) {
  Clip clip;
  clip.skeleton.add("a", -1, {});
  const std::string text = written(clip);
  EXPECT_EQ(read_back(text).clip.frame_count(), 0);
}

// A chain of n joints that were indented as deep as they hang would take n * n tabs.
TEST(BvhWriter, DeepChainsStayInProportion) {
  Clip clip;
  clip.skeleton.add("0", -1, {});
  for (int j = 1; j < 20000; ++j) clip.skeleton.add(std::to_string(j), j - 1, {});
  EXPECT_LT(written(clip).size(), 10'000'000u);
}

TEST(BvhWriter, RefusesWhatItCannotWrite) {
  auto file =
      OutputFile::create(testing::TempDir() + "krok_unit_bvh_refused_" + std::to_string(getpid()));
  ASSERT_TRUE(file.ok());
  Clip clip = arm_clip(2);
  WriteOptions options;
  options.decimals = 99;
  EXPECT_EQ(write(clip, options, *file).error().code, "bvh-options");
  options = {};
  options.order = {Axis::x, Axis::x, Axis::z};
  EXPECT_EQ(write(clip, options, *file).error().code, "bvh-options");
  options = {};
  options.unit_metres = 0;
  EXPECT_EQ(write(clip, options, *file).error().code, "bvh-options");
  clip.positions[0].x() = std::nanf("");
  EXPECT_EQ(write(clip, {}, *file).error().code, "clip-value");
  EXPECT_EQ(file->size(), 0u);
}

TEST(BvhWriter, FramesMadeWhenAskedForGiveTheSameText) {
  Clip clip = arm_clip(700);
  clip.frame_positions(650)[1].x() += 0.5F;  // a late frame makes the joint one that moves
  const std::string expected = written(clip);
  EXPECT_EQ(expected.find("CHANNELS 3"), std::string::npos);
  for (const int jobs : {1, 2, 5}) {
    FrameSource source = frames_of(clip);
    int released = 0;
    source.release = [&](int frame) { released = frame; };
    WriteOptions options;
    options.jobs = jobs;
    EXPECT_EQ(written(source, options), expected) << jobs;
    EXPECT_EQ(released, 700);
  }
}

}  // namespace
}  // namespace krok::bvh
