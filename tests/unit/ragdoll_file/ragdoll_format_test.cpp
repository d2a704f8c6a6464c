// If these fail, bodies and joints are read as others than the file says, a saved file gives
// another fall than the one it was saved from, or a mistake in a file is passed over or reported at
// the wrong place.

#include "formats/ragdoll/ragdoll_format.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "math/quaternion.h"
#include "ragdoll/simulate.h"
#include "samples/generator/walk.h"
#include "support/human_skeleton.h"
#include "support/told_mistakes.h"

namespace krok::ragdoll_file {
namespace {

using ragdoll::Body;
using ragdoll::JointKind;
using ragdoll::JointRule;

constexpr const char* kGood = R"({
  "schema": "krok.ragdoll/1",
  "bodies": [
    {"name": "pelvis", "joint": "Hips", "shape": "box", "size": [0.3, 0.16, 0.2], "mass": 11},
    {"name": "thigh", "joint": "LeftUpLeg", "shape": "capsule", "radius": 0.07, "length": 0.28,
     "mass": 10.5, "offset": [0, -0.21, 0]},
    {"name": "shank", "joint": "LeftLeg", "shape": "sphere", "radius": 0.05, "mass": 3}
  ],
  "joints": [
    {"kind": "spherical", "child": "thigh", "turn": {"axis": [0, -1, 0], "swing_axis": [1, 0, 0],
     "swing": [[-120, 20], [-30, 40]], "twist": [-40, 40]}, "friction": 2},
    {"kind": "revolute", "parent": "thigh", "child": "shank", "axis": [1, 0, 0], "range": [0, 145],
     "limit": "soft", "stiffness": 40},
    {"kind": "distance", "parent": null, "child": "shank", "range": [null, 0.9]}
  ]
})";

class RagdollFormat : public testing::Test {
 protected:
  RagdollFormat() {
    samples::WalkOptions options;
    options.steps = 4;
    options.rate = 60;
    walk_ = samples::make_walk(options)->clip;
    roles_ = find_roles(walk_.skeleton);
    limits_ = ik::anatomical_limits(walk_.skeleton, roles_);
    bodies_ = *ragdoll::make_bodies(walk_.skeleton, roles_);
  }

  std::vector<JointRule> rules(double time) const {
    const auto pose = ragdoll::pose_at(walk_, time);
    return ragdoll::rules_of(
        ragdoll::make_joints(walk_.skeleton, roles_, bodies_, limits_, pose, {}), walk_.skeleton,
        bodies_, limits_, pose);
  }

  ragdoll::Fall fall(const std::vector<Body>& bodies, const std::vector<JointRule>& rules,
                     double at) const {
    ragdoll::FallOptions options;
    options.at = at;
    options.duration = 1;
    options.rules = rules;
    options.surroundings.level = true;
    options.pushes.push_back({2, Vec3(60, 0, 20), at});
    auto fall = ragdoll::simulate_fall(walk_, roles_, bodies, limits_, options);
    EXPECT_TRUE(fall.ok());
    return std::move(*fall);
  }

  int body(const std::string& name) const {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (bodies_[b].name == name) return static_cast<int>(b);
    }
    return -1;
  }

  Clip walk_;
  RoleMap roles_;
  ik::Limits limits_;
  std::vector<Body> bodies_;
};

TEST_F(RagdollFormat, ReadsWhatTheSpecSays) {
  const auto read_well = read(kGood, &walk_.skeleton);
  ASSERT_TRUE(read_well.ok()) << read_well.error().message;
  const auto& [bodies, joints] = *read_well;
  ASSERT_EQ(bodies.size(), 3u);
  EXPECT_EQ(bodies[0].shape.half, Vec3(0.15, 0.08, 0.1));
  EXPECT_EQ(bodies[1].shape.half_length, 0.14);
  EXPECT_EQ(bodies[1].to_joint.position, Vec3(0, -0.21, 0));
  EXPECT_EQ(bodies[2].shape.kind, ragdoll::Shape::Kind::sphere);
  EXPECT_EQ(bodies[2].parent, 1);
  EXPECT_EQ(bodies[2].joint, walk_.skeleton.find("LeftLeg"));
  ASSERT_EQ(joints.size(), 3u);
  EXPECT_EQ(joints[0].parent, 0);  // the body above
  EXPECT_NEAR(joints[0].turn.min_swing[0], -120 * kRadiansPerDegree, 1e-12);
  EXPECT_FALSE(joints[0].soft);
  EXPECT_EQ(joints[1].kind, JointKind::revolute);
  EXPECT_TRUE(joints[1].soft);
  EXPECT_EQ(joints[1].stiffness, 40);
  EXPECT_EQ(joints[2].parent, -1);
  EXPECT_EQ(joints[2].range.min, 0);
  EXPECT_EQ(joints[2].range.max, 0.9);
}

TEST_F(RagdollFormat, ASavedFileGivesTheSameFall) {
  for (const double at : {0.3, 1.1}) {
    const auto saved = rules(at);
    const std::string text = write({bodies_, saved}, walk_.skeleton);
    const auto again = read(text, &walk_.skeleton);
    ASSERT_TRUE(again.ok()) << again.error().message;
    EXPECT_EQ(write(*again, walk_.skeleton), text);
    EXPECT_EQ(fall(again->bodies, again->joints, at).clip.orientations,
              fall(bodies_, saved, at).clip.orientations);
  }
}

// Modes come back as they were written; files without them, which are all older ones, stay as they
// are, byte for byte.
TEST_F(RagdollFormat, ModesAreKept) {
  const auto saved = rules(0.3);
  EXPECT_EQ(write({bodies_, saved}, walk_.skeleton).find("mode"), std::string::npos);
  std::vector<Body> bodies = bodies_;
  bodies[0].mode = bodies[1].mode = ragdoll::BodyMode::animated;
  bodies[2].mode = ragdoll::BodyMode::powered;
  bodies[2].strength = 0.35;
  const std::string text = write({bodies, saved}, walk_.skeleton);
  const auto again = read(text, &walk_.skeleton);
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(write(*again, walk_.skeleton), text);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_EQ(again->bodies[b].mode, bodies[b].mode);
    EXPECT_EQ(again->bodies[b].strength, bodies[b].strength);
  }
}

TEST_F(RagdollFormat, WrongModesAreToldWithTheirPlace) {
  const test::Mistake mistakes[] = {
      {"\"mass\": 11", "\"mass\": 11, \"mode\": \"limp\"", "ragdoll-value 4:103", "powered"},
      {"\"mass\": 11", "\"mass\": 11, \"strength\": 0.5", "ragdoll-value 4:107", "not powered"},
      {"\"mass\": 11", "\"mass\": 11, \"mode\": \"powered\", \"strength\": 1.5",
       "ragdoll-value 4:126", "strength"},
      {"\"mass\": 3", "\"mass\": 3, \"mode\": \"animated\"", "ragdoll-value 7:97", "thigh"}};
  test::expect_told(kGood, mistakes,
                    [&](const std::string& text) { return read(text, &walk_.skeleton); });
}

// Rules are the joints themselves, with angles rounded: the first steps of the falls agree.
TEST_F(RagdollFormat, RulesAreTheJointsThatWereMade) {
  const auto pose = ragdoll::pose_at(walk_, 0.7);
  const auto made = ragdoll::make_joints(walk_.skeleton, roles_, bodies_, limits_, pose, {});
  const auto ruled = ragdoll::joints_of(rules(0.7), bodies_, pose);
  ASSERT_EQ(made.size(), ruled.size());
  for (std::size_t j = 0; j < made.size(); ++j) {
    EXPECT_LT((made[j].in_parent.position - ruled[j].in_parent.position).norm(), 1e-12);
    EXPECT_LT((made[j].in_child.position - ruled[j].in_child.position).norm(), 1e-12);
    EXPECT_EQ(made[j].kind, ruled[j].kind);
    if (made[j].kind != JointKind::revolute) continue;
    // The angles that the range allows are the same, whatever they count from.
    const auto open = [&](const ragdoll::Joint& joint) {
      const Quat now = pose[at(bodies_[at(joint.parent)].joint)].orientation.conjugate() *
                       pose[at(bodies_[at(joint.child)].joint)].orientation;
      const Quat parent =
          bodies_[at(joint.parent)].to_joint.orientation * joint.in_parent.orientation;
      const Quat child = bodies_[at(joint.child)].to_joint.orientation * joint.in_child.orientation;
      const Quat turn = parent.conjugate() * now * child;
      return joint.range.max - 2 * std::atan2(turn.x(), turn.w());
    };
    EXPECT_NEAR(std::remainder(open(made[j]) - open(ruled[j]), 2 * kPi), 0, 1e-6);
  }
}

// A file serves another moment of the motion: what the pose leaves is widened, so that nothing
// jerks. Without, bent limbs are thrown about in the first steps.
TEST_F(RagdollFormat, ASavedFileServesAnotherPose) {
  const auto saved = rules(0.3);
  const ragdoll::Fall other = fall(bodies_, saved, 1.1);
  EXPECT_LT(other.largest.limit_excess, 0.0175);
  EXPECT_LT(other.settling.joint_gap, 0.005);
}

// A knee that is made a fixed joint keeps its angle through the whole fall, and a rope between hand
// and pelvis its length.
TEST_F(RagdollFormat, EditedJointsHold) {
  auto edited = rules(0.7);
  for (JointRule& rule : edited) {
    if (rule.child == body("left_shank")) rule.kind = JointKind::fixed;
  }
  JointRule rope;
  rope.kind = JointKind::distance;
  rope.parent = body("pelvis");
  rope.child = body("left_lower_arm");
  rope.other_end = Vec3::Zero();
  rope.range = {0, 0.6};
  edited.push_back(rope);
  const auto again = read(write({bodies_, edited}, walk_.skeleton), &walk_.skeleton);
  ASSERT_TRUE(again.ok()) << again.error().message;
  const ragdoll::Fall tied = fall(again->bodies, again->joints, 0.7);
  const int knee = walk_.skeleton.find("LeftLeg"), hips = walk_.skeleton.find("Hips");
  const int elbow = walk_.skeleton.find("LeftForeArm");
  const auto bend = [&](int frame) {
    return angle_between(
        tied.clip.frame_orientations(frame)[at(walk_.skeleton.parents[at(knee)])].cast<double>(),
        tied.clip.frame_orientations(frame)[at(knee)].cast<double>());
  };
  double apart = 0;
  for (int f = tied.first_frame; f < tied.clip.frame_count(); ++f) {
    EXPECT_NEAR(bend(f), bend(tied.first_frame), 0.01) << f;
    apart = std::max<double>(
        apart,
        (tied.clip.frame_positions(f)[at(hips)] - tied.clip.frame_positions(f)[at(elbow)]).norm());
  }
  EXPECT_LT(apart, 0.605);
}

TEST_F(RagdollFormat, MistakesAreToldWithTheirPlace) {
  const test::Mistake mistakes[] = {
      {"krok.ragdoll/1", "krok.ragdoll/9", "ragdoll-structure 2:13"},
      {"\"Hips\"", "\"Hip\"", "ragdoll-joint 4:33", "Hips"},
      {"\"LeftLeg\"", "\"LeftUpLeg\"", "ragdoll-joint 7:32", "already"},
      {"\"LeftLeg\"", "\"RightLeg\"", "ragdoll-body 7:5", "ties"},
      {"\"Hips\"", "\"Spine\"", "ragdoll-joint 5:32", "root"},
      {"\"thigh\"", "\"pelvis\"", "ragdoll-value 5:14", "two bodies"},
      {"\"box\"", "\"boxx\"", "ragdoll-value 4:50", "capsule"},
      {"\"box\"", "\"sphere\"", "ragdoll-value 4:68", "does not use"},
      {"[0.3, 0.16, 0.2]", "[0.3, 0, 0.2]", "ragdoll-value 4:65", "0.1 mm"},
      {"[0.3, 0.16, 0.2]", "[0.3, 0.16]", "ragdoll-value 4:65", "3 numbers"},
      {"\"mass\": 11", "\"mass\": 0", "ragdoll-value 4:91", "mass"},
      {"\"mass\": 11", "\"mass\": NaN", "json-syntax 4:91"},
      {"\"mass\": 11", "\"weight\": 11", "ragdoll-structure 4:83", "mass"},
      {"\"radius\": 0.07", "\"radius\": -1", "ragdoll-value 5:75", "radius"},
      {"\"child\": \"thigh\"", "\"child\": \"tigh\"", "ragdoll-body 10:36", "thigh"},
      {"\"child\": \"shank\"", "\"child\": \"thigh\"", "ragdoll-value 12:36", "itself"},
      {"\"spherical\"", "\"ball\"", "ragdoll-value 10:14", "spherical"},
      {"\"spherical\"", "\"fixed\"", "ragdoll-value 10:49", "not used"},
      {"[0, -1, 0]", "[0, -2, 0]", "ragdoll-value 10:62", "length 2"},
      {"[1, 0, 0],\n     \"swing\"", "[0, 1, 0],\n     \"swing\"", "ragdoll-value 10:88",
       "perpendicular"},
      {"[-120, 20]", "[12, 20]", "ragdoll-value 11:16", "contain 0"},
      {"[0, 145]", "[145, 0]", "ragdoll-value 12:91", "above"},
      {"[0, 145]", "[0, 1450]", "ragdoll-value 12:91", "exceeds"},
      {"\"soft\"", "\"hard\"", "ragdoll-value 13:36", "not used"},
      {"\"stiffness\": 40", "\"stiffness\": -4", "ragdoll-value 13:36", "stiffness"},
      {"[null, 0.9]", "[-1, 0.9]", "ragdoll-value 14:69", "exceeds"}};
  test::expect_told(kGood, mistakes,
                    [&](const std::string& text) { return read(text, &walk_.skeleton); });
}

TEST_F(RagdollFormat, DamagedTextsNeverGiveWhatCannotFall) {
  std::mt19937 random(5);
  int read_well = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::string text = test::damaged(kGood, random);
    const auto found = read(text, i % 2 == 0 ? &walk_.skeleton : nullptr);
    if (!found) {
      EXPECT_GE(found.error().where.line, 1u) << text;
      continue;
    }
    ++read_well;
    for (const Body& body : found->bodies) {
      EXPECT_TRUE(volume(body.shape) > 0 && std::isfinite(volume(body.shape)));
      EXPECT_TRUE(body.mass > 0 && std::isfinite(body.mass));
      EXPECT_NEAR(body.to_joint.orientation.norm(), 1, 1e-9);
      EXPECT_LT(body.parent, static_cast<int>(found->bodies.size()));
    }
    for (const JointRule& rule : found->joints) {
      EXPECT_LE(rule.range.min, rule.range.max);
      EXPECT_NE(rule.parent, rule.child);
      EXPECT_GE(rule.stiffness, 0);
    }
  }
  EXPECT_GT(read_well, 100);
}

}  // namespace
}  // namespace krok::ragdoll_file
