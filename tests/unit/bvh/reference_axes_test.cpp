// If these fail, a file whose reference pose stands on other axes than its motion comes in lying
// down, or a mesh that was bound in the reference pose does not follow the joints.

#include <cmath>
#include <filesystem>

#include "math/quaternion.h"
#include "support/this_build.h"
#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

// A joint's child stands where the bone of the reference pose is carried by the joint's turn since
// that pose; the largest distance from there over all frames, metres. For joints that only turn.
double largest_distance_from_bones(const Clip& clip) {
  const auto& skeleton = clip.skeleton;
  std::vector<Transform> pose(skeleton.names.size());
  double largest = 0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.get_pose(frame, pose);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      if (skeleton.parents[j] < 0) continue;
      const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
      const Transform& reference = skeleton.reference[parent];
      const Quat turned = pose[parent].orientation * reference.orientation.conjugate();
      const Vec3 bone = skeleton.reference[j].position - reference.position;
      const Vec3 expected = pose[parent].position + turned * bone;
      largest = std::max(largest, (pose[j].position - expected).norm());
    }
  }
  return largest;
}

// A person stored y-up and facing +z, whom the root turns upright in a world with z up, facing -y.
// `turn` degrees about x do that.
std::string stored_lying(const std::string& rows, int frames) {
  const std::string turns = " CHANNELS 3 Zrotation Xrotation Yrotation\n";
  const auto joint = [&](const char* name, const char* offset) {
    return std::string(" JOINT ") + name + "\n {\n OFFSET " + offset + "\n" + turns;
  };
  const auto end = [](const char* offset) {
    return std::string(" End Site\n {\n OFFSET ") + offset + "\n }\n";
  };
  std::string text =
      "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation "
      "Xrotation Yrotation\n";
  text += joint("Spine", "0 20 0") + joint("Neck", "0 30 0") + joint("Head", "0 10 0") +
          end("0 18 0") + " }\n }\n";
  for (const bool left : {true, false}) {
    const std::string side = left ? "Left" : "Right";
    const auto x = [&](const char* rest) { return std::string(left ? "" : "-") + rest; };
    text += joint((side + "Arm").c_str(), x("18 28 0").c_str()) +
            joint((side + "ForeArm").c_str(), x("28 0 0").c_str()) +
            joint((side + "Hand").c_str(), x("25 0 0").c_str()) + end(x("15 0 0").c_str()) +
            " }\n }\n }\n";
  }
  text += " }\n";
  for (const bool left : {true, false}) {
    const std::string side = left ? "Left" : "Right";
    text += joint((side + "UpLeg").c_str(), left ? "10 -5 0" : "-10 -5 0") +
            joint((side + "Leg").c_str(), "0 -42 0") + joint((side + "Foot").c_str(), "0 -40 0") +
            end("0 -5 15") + " }\n }\n }\n";
  }
  return text + "}\n" + motion(frames, rows);
}

std::string lying_row(double turn, double bend) {
  std::string row = "10 20 95 0 " + std::to_string(turn) + " 0";
  for (int value = 0; value < 45; ++value) {
    row += " " + std::to_string(value % 3 == 0 ? bend : -bend / 2);
  }
  return row + "\n";
}

TEST(ReferenceAxes, TheReferencePoseStandsUprightWhereTheRootRaisesIt) {
  std::string rows;
  for (int frame = 0; frame < 8; ++frame) rows += lying_row(90 + frame, 2.0 * frame);
  const std::string text = stored_lying(rows, 8);
  const Capture capture = read_ok(text, ReadOptions());
  const Conventions& found = capture.conventions;
  EXPECT_EQ(found.up, Direction::plus_z);
  EXPECT_EQ(found.reference_up, Direction::plus_y);
  const Clip& clip = capture.clip;
  ASSERT_TRUE(check(clip).ok());
  const Skeleton& skeleton = clip.skeleton;
  const auto at = [&](const char* name) {
    return skeleton.reference[static_cast<std::size_t>(skeleton.find(name))].position;
  };
  EXPECT_GT(at("Head").y() - at("LeftFoot").y(), 1.2);
  EXPECT_GT(at("LeftHand").x() - at("RightHand").x(), 1.0);
  EXPECT_GT(at("LeftFoot_end").z() - at("LeftFoot").z(), 0.1);
  for (const Transform& joint : skeleton.reference) {
    EXPECT_EQ(joint.orientation.coeffs(), Quat::Identity().coeffs());
  }
  EXPECT_LT(largest_distance_from_bones(clip), 1e-5);

  // The world positions are the file's, turned by the motion's axes.
  const Clip plain = read_ok(text).clip;
  const Quat turn = *rotation_to_krok(found.up, found.forward);
  for (std::size_t i = 0; i < clip.positions.size(); ++i) {
    const Vec3 expected = turn * (plain.positions[i].cast<double>() * found.unit.metres);
    ASSERT_LT((clip.positions[i].cast<double>() - expected).norm(), 1e-5) << i;
  }
  EXPECT_GT(clip.positions[static_cast<std::size_t>(skeleton.find("Head"))].y(), 1.2f);
}

TEST(ReferenceAxes, GivenAxesHoldForBoth) {
  ReadOptions options;
  options.up = Direction::plus_z;
  options.forward = Direction::minus_y;
  const Capture capture = read_ok(stored_lying(lying_row(90, 5) + lying_row(91, 6), 2), options);
  EXPECT_EQ(capture.conventions.reference_up, Direction::plus_z);
  EXPECT_LT(largest_distance_from_bones(capture.clip), 1e-5);
}

// A person whose bones lie along x without turns, legs folded up; two turns make it stand: the
// root's about z, from x to y, and the thighs'.
std::string stored_folded(double heading) {
  const std::string turns = " CHANNELS 3 Zrotation Xrotation Yrotation\n";
  const auto joint = [&](const std::string& name, const char* offset, const std::string& below) {
    return " JOINT " + name + "\n {\n OFFSET " + offset + "\n" + turns + below + " }\n";
  };
  const std::string end = " End Site\n {\n OFFSET 10 0 0\n }\n";
  std::string text =
      "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Yrotation "
      "Zrotation Xrotation\n";
  std::string arms;
  std::string row = "0 95 0 " + std::to_string(heading) + " 90 0";
  for (const bool left : {true, false}) {
    const std::string side = left ? "Left" : "Right";
    text += joint(side + "UpLeg", left ? "-5 0 10" : "-5 0 -10",
                  joint(side + "Leg", "42 0 0", joint(side + "Foot", "42 0 0", end)));
    row += " 180 0 0 0 0 0 0 0 0";
    arms += joint(side + "Arm", left ? "25 0 15" : "25 0 -15",
                  joint(side + "ForeArm", "28 0 0", joint(side + "Hand", "25 0 0", end)));
  }
  text += joint("Spine", "10 0 0", arms + joint("Neck", "35 0 0", joint("Head", "10 0 0", end)));
  for (int value = 0; value < 27; ++value) row += " 0";
  return text + "}\n" + motion(2, row + "\n" + row + "\n");
}

TEST(ReferenceAxes, TheHipsFaceWhereTheActorDoesThoughTheReferencePoseFolds) {
  for (const double heading : {0.0, 30.0, 90.0, 200.0}) {
    const Capture capture = read_ok(stored_folded(heading), ReadOptions());
    const Clip& clip = capture.clip;
    EXPECT_EQ(capture.conventions.reference_up, Direction::plus_x) << heading;
    EXPECT_EQ(capture.conventions.reference_forward, Direction::plus_y) << heading;
    EXPECT_LT(largest_distance_from_bones(clip), 1e-5);
    const auto joint = [&](const char* name) {
      return static_cast<std::size_t>(clip.skeleton.find(name));
    };
    const Vec3 left =
        (clip.positions[joint("LeftUpLeg")] - clip.positions[joint("RightUpLeg")]).cast<double>();
    const Vec3 ahead = clip.orientations[joint("Hips")].cast<double>() * Vec3::UnitZ();
    EXPECT_LT((ahead - left.normalized().cross(Vec3::UnitY())).norm(), 1e-5) << heading;
    EXPECT_GT(clip.positions[joint("Head")].y(), clip.positions[joint("LeftFoot")].y() + 1);
  }
}

TEST(ReferenceAxes, CapturesStandUprightAndFollowTheirBones) {
  int found = 0;
  for (const char* name : {"bvh_test3", "bvh_test4"}) {
    const std::string path = test::corpus_folder() + "/bvh/pybvh/" + name + ".bvh";
    if (!std::filesystem::exists(path)) continue;
    ++found;
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    ReadOptions options;
    const Capture capture = read_ok(text.str(), options);
    EXPECT_NE(capture.conventions.up, capture.conventions.reference_up) << name;
    EXPECT_LT(largest_distance_from_bones(capture.clip), 1e-5) << name;
    const Conventions again =
        detect_conventions(capture.clip.skeleton, find_roles(capture.clip.skeleton), {});
    EXPECT_EQ(again.up, Direction::plus_y) << name;
    EXPECT_EQ(again.forward, Direction::plus_z) << name;
  }
  if (found == 0) GTEST_SKIP() << "skipped: no corpus at " << test::corpus_folder();
}

}  // namespace
}  // namespace krok::bvh
