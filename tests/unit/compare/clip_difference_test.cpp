// If these fail, two motions or cameras pass for the same that are not, or differences are reported
// at the wrong joint and frame.

#include "compare/clip_difference.h"

#include <gtest/gtest.h>

#include <limits>

#include "compare/model_difference.h"
#include "math/quaternion.h"

namespace krok::compare {
namespace {

Clip make_clip(int frames = 20, double rate = 30) {
  Clip clip;
  clip.skeleton.add("Hips", -1, {Vec3(0, 1, 0), Quat::Identity()});
  clip.skeleton.add("Hand", 0, {Vec3(0, 1.5, 0), Quat::Identity()});
  clip.skeleton.add("Foot", 0, {Vec3(0, 0.1, 0), Quat::Identity()});
  clip.rate = rate;
  clip.resize(frames);
  for (int f = 0; f < frames; ++f) {
    std::vector<Transform> pose = clip.skeleton.reference;
    for (Transform& joint : pose) {
      joint.position.x() += f / rate;
      joint.orientation = from_rotation_vector(Vec3(0, 3.0 * f / rate, 0.1));
    }
    clip.set_pose(f, pose);
  }
  return clip;
}

ClipDifference compare(const Clip& a, const Clip& b) {
  const auto found = difference(a, b, {});
  EXPECT_TRUE(found.ok()) << found.error().message;
  return found.ok() ? *found : ClipDifference();
}

// Would fail if the hand were blamed for what the arm does: all that hangs on a joint turns as far,
// but for rounding.
TEST(ClipDifference, OfATurnedLimbTheTopmostJointIsNamed) {
  Totals totals(1e-4);
  for (int frame = 0; frame < 5; ++frame) {
    for (int joint = 3; joint < 9; ++joint) {
      totals.add(0.1 * (1 + 1e-6 * (joint + frame)), {.joint = joint, .frame = frame});
    }
  }
  EXPECT_EQ(totals.where.joint, 3);
  EXPECT_DOUBLE_EQ(totals.largest, 0.1 * (1 + 12e-6));
  Totals moments(1e-4);
  moments.merge(totals);
  Totals other(1e-4);
  other.add(0.1 * (1 + 2e-5), {.joint = 7, .frame = 9});
  moments.merge(other);
  EXPECT_EQ(moments.where.joint, 3);
  other.add(0.11, {.joint = 7, .frame = 9});
  moments.merge(other);
  EXPECT_EQ(moments.where.joint, 7);
  EXPECT_EQ(moments.count, 33);
}

TEST(ClipDifference, ACopyIsTheSame) {
  Clip copy = make_clip();
  copy.provenance.tool = "another";
  const ClipDifference found = compare(make_clip(), copy);
  EXPECT_TRUE(found.same());
  EXPECT_EQ(found.compared_frames, 20);
  EXPECT_EQ(found.positions.count, 60);
  EXPECT_EQ(found.positions.largest, 0);
}

TEST(ClipDifference, FindsOneJointMovedByATenthOfAMillimetre) {
  Clip moved = make_clip();
  moved.frame_positions(13)[1].z() += 1e-4f;
  const ClipDifference found = compare(make_clip(), moved);
  EXPECT_FALSE(found.same());
  EXPECT_NEAR(found.positions.largest, 1e-4, 1e-9);
  EXPECT_EQ(found.positions.where.joint, 1);
  EXPECT_EQ(found.positions.where.frame, 13);
  EXPECT_DOUBLE_EQ(found.positions.where.time, 13 / 30.0);
  EXPECT_EQ(found.positions.over, 1);
  EXPECT_TRUE(found.orientations.within());
}

TEST(ClipDifference, AQuaternionAndItsNegativeAreTheSame) {
  Clip negative = make_clip();
  for (Quatf& q : negative.orientations) q.coeffs() = -q.coeffs();
  const ClipDifference found = compare(make_clip(), negative);
  EXPECT_TRUE(found.same());
  EXPECT_LT(found.orientations.largest, 1e-7);
}

TEST(ClipDifference, MeasuresAnglesOfOrientations) {
  Clip turned = make_clip();
  Quatf& q = turned.frame_orientations(4)[2];
  q = (q.cast<double>() * from_rotation_vector(Vec3(0.002, 0, 0))).cast<float>();
  const ClipDifference found = compare(make_clip(), turned);
  EXPECT_NEAR(found.orientations.largest, 0.002, 1e-6);
  EXPECT_EQ(found.orientations.where.joint, 2);
  EXPECT_EQ(found.orientations.where.frame, 4);
}

TEST(ClipDifference, TheOrderOfJointsDoesNotMatter) {
  const Clip clip = make_clip();
  Clip swapped = clip;
  std::swap(swapped.skeleton.names[1], swapped.skeleton.names[2]);
  std::swap(swapped.skeleton.reference[1], swapped.skeleton.reference[2]);
  for (int f = 0; f < swapped.frame_count(); ++f) {
    std::swap(swapped.frame_positions(f)[1], swapped.frame_positions(f)[2]);
  }
  EXPECT_TRUE(compare(clip, swapped).same());
}

TEST(ClipDifference, SaysWhichJointsDiffer) {
  Clip other = make_clip();
  other.skeleton.names[1] = "LeftHand";
  const ClipDifference renamed = compare(make_clip(), other);
  ASSERT_EQ(renamed.structure.size(), 1u);
  EXPECT_NE(renamed.structure[0].find("only in the first: Hand"), std::string::npos);
  EXPECT_NE(renamed.structure[0].find("only in the second: LeftHand"), std::string::npos);
  EXPECT_FALSE(renamed.same());

  other = make_clip();
  other.skeleton.parents[2] = 1;
  const ClipDifference hung = compare(make_clip(), other);
  ASSERT_EQ(hung.structure.size(), 1u);
  EXPECT_EQ(hung.structure[0], "the parent of Foot is Hips in the first and Hand in the second");

  other = make_clip();
  other.skeleton.end_sites[2] = 1;
  EXPECT_FALSE(compare(make_clip(), other).same());
}

TEST(ClipDifference, ComparesTheFramesThatBothHave) {
  const ClipDifference longer = compare(make_clip(20), make_clip(25));
  EXPECT_FALSE(longer.same());
  EXPECT_EQ(longer.compared_frames, 20);
  EXPECT_TRUE(longer.positions.within());
  ASSERT_EQ(longer.structure.size(), 1u);
  EXPECT_EQ(longer.structure[0], "20 frames in the first, 25 in the second");

  // Twice the rate: every second frame of the second.
  const ClipDifference faster = compare(make_clip(20, 30), make_clip(39, 60));
  EXPECT_FALSE(faster.same());
  EXPECT_EQ(faster.compared_frames, 20);
  EXPECT_LT(faster.positions.largest, 1e-6);
  EXPECT_LT(faster.orientations.largest, 1e-6);
  EXPECT_EQ(faster.structure.size(), 2u);

  EXPECT_EQ(compare(make_clip(0), make_clip(3)).compared_frames, 0);
  EXPECT_TRUE(compare(make_clip(0), make_clip(0)).same());
}

// A squashed ball would pass for a round one. Rigid joints have none to compare.
TEST(ClipDifference, StretchesAreCompared) {
  const Clip clip = make_clip();
  Stretches first(clip.positions.size());
  first[3 * 7 + 2] = {1.5f, 1, 1, 0, 0, 0};
  Stretches second = first;
  second[3 * 7 + 2].xx = 1.4f;
  const auto same = *difference(clip, clip, {}, Matching::automatic, first, first);
  EXPECT_TRUE(same.same());
  EXPECT_EQ(same.stretches.count, 1);
  const auto other = *difference(clip, clip, {}, Matching::automatic, first, second);
  EXPECT_FALSE(other.same());
  EXPECT_NEAR(other.stretches.largest, 0.1, 1e-6);
  EXPECT_EQ(other.stretches.where.joint, 2);
  EXPECT_EQ(other.stretches.where.frame, 7);
  const auto rigid = *difference(clip, clip, {}, Matching::automatic, {}, first);
  EXPECT_NEAR(rigid.stretches.largest, 0.5, 1e-6);
  EXPECT_EQ(difference(clip, clip, {}, Matching::automatic, std::span(first).first(3)).error().code,
            "stretch-shape");
}

TEST(ClipDifference, ValuesThatAreNotNumbersAreTrouble) {
  Clip bad = make_clip();
  bad.frame_positions(3)[0].y() = std::numeric_limits<float>::quiet_NaN();
  const auto found = difference(make_clip(), bad, {});
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, "clip-value");
  EXPECT_NE(found.error().message.find("second"), std::string::npos);
}

CameraTrack make_camera() {
  CameraTrack camera;
  for (int f = 0; f < 5; ++f) {
    camera.positions.emplace_back(0.0f, 1.0f, static_cast<float>(f));
    camera.orientations.push_back(Quatf::Identity());
    camera.fields_of_view.push_back(0.8f);
  }
  return camera;
}

TEST(CameraDifference, MeasuresPositionOrientationAndFieldOfView) {
  EXPECT_TRUE(difference(make_camera(), make_camera(), {})->same());
  CameraTrack other = make_camera();
  other.positions[2].x() = 0.25f;
  other.fields_of_view[3] = 0.9f;
  other.orientations[4].coeffs() *= -1.0f;
  const auto found = difference(make_camera(), other, {});
  ASSERT_TRUE(found.ok());
  EXPECT_FALSE(found->same());
  EXPECT_EQ(found->positions.largest, 0.25);
  EXPECT_EQ(found->positions.where.frame, 2);
  EXPECT_NEAR(found->fields_of_view.largest, 0.1, 1e-6);
  EXPECT_EQ(found->fields_of_view.where.frame, 3);
  EXPECT_TRUE(found->orientations.within());
  // A film with a cut shows something else between the same frames.
  other = make_camera();
  other.cuts = {2};
  EXPECT_FALSE(difference(make_camera(), other, {})->same());
}

}  // namespace
}  // namespace krok::compare
