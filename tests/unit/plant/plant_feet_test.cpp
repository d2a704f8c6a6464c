// If these fail, --plant leaves feet sliding, or breaks something else to hold them: bones that
// change their lengths, an upper body that turns, a foot that no longer rolls off over its ball.

#include "plant/plant_feet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "motion/hips_root.h"
#include "plant/foot_paths_internal.h"
#include "samples/generator/gesture.h"
#include "support/human_skeleton.h"
#include "support/planted_measures.h"
#include "unit/contacts/events.h"

namespace krok {
namespace {

samples::Walk plain_walk() {
  samples::WalkOptions options;
  options.steps = 6;
  return samples::make_walk(options).value();
}

PlantedFeet planted(const Clip& clip, std::optional<std::span<const Contact>> contacts = {}) {
  auto result = plant_feet(clip, find_roles(clip.skeleton), contacts);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return result.ok() ? std::move(*result) : PlantedFeet{};
}

const FixedStay* stay_of(const PlantedFeet& feet, FootPart part, int after = 0) {
  for (const FixedStay& stay : feet.stays) {
    if (stay.point.part == part && stay.first > after) return &stay;
  }
  return nullptr;
}

TEST(PlantFeet, SlidesAndJitterAreGone) {
  const samples::Walk walk = plain_walk();
  const Clip input = test::with_skate(walk, {});
  const PlantedFeet feet = planted(input);
  const auto measures =
      test::measure(input, walk.clip, find_roles(input.skeleton), feet.stays, feet.clip);
  EXPECT_GT(feet.drift_before, 0.02);
  EXPECT_LT(measures.drift, 0.0005);
  EXPECT_LE(feet.drift_after, measures.drift + 1e-9);
  EXPECT_LT(measures.knee_99, 1.2);
  EXPECT_LT(measures.stretch, 2e-6);
  EXPECT_GE(measures.stays, 12);
  EXPECT_EQ(feet.out_of_reach, 0);
  EXPECT_TRUE(check(feet.clip).ok());
}

// Would fail if steps that jitter hides were left sliding without a word.
TEST(PlantFeet, StancesWithoutContactsAreTold) {
  samples::WalkOptions options;
  options.steps = 8;
  const auto missed = [](const PlantedFeet& feet) {
    return std::ranges::any_of(feet.warnings,
                               [](const Diagnostic& d) { return d.code == "plant-missed"; });
  };
  Clip clip = samples::make_walk(options).value().clip;
  EXPECT_FALSE(missed(planted(clip)));
  // One foot slides throughout, as in captures at a low rate.
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      const auto i = static_cast<std::size_t>(j);
      const std::string& name = clip.skeleton.names[i];
      if (!name.starts_with("LeftFoot") && !name.starts_with("LeftToe")) continue;
      clip.frame_positions(f)[i].z() += 0.4f * static_cast<float>(f / clip.rate);
    }
  }
  EXPECT_TRUE(missed(planted(clip)));
}

// Turns all that is below a joint about it.
void turn_below(int joint, int frame, const Quat& turn, Clip& clip) {
  const Transform about = test::joint_of(clip, frame, joint);
  const auto within = subtree(clip.skeleton, joint);
  for (std::size_t j = 0; j < within.size(); ++j) {
    if (within[j] == 0) continue;
    const Transform now = test::joint_of(clip, frame, static_cast<int>(j));
    clip.frame_positions(frame)[j] =
        (about.position + turn * Vec3(now.position - about.position)).cast<float>();
    clip.frame_orientations(frame)[j] = (turn * now.orientation).cast<float>();
  }
}

// Toes whose bend is noise, as in many captures. Would fail if the foot were raised, by as much as
// their ends go down, to hold these where they are once the ball has left.
TEST(PlantFeet, NoFootIsRaisedForToesThatBendDown) {
  Clip clip = samples::make_gesture({}).value();
  const RoleMap roles = find_roles(clip.skeleton);
  const int ball_leaves = 20, tip_leaves = 40;
  for (int f = 0; f < tip_leaves; ++f) {
    const double angle = f >= ball_leaves ? 0.5 + 0.1 * (f % 3) : f % 2 == 0 ? 0.3 : -0.3;
    turn_below(roles.joint(Role::left_toes), f, from_rotation_vector(Vec3(angle, 0, 0)), clip);
  }
  const auto body = plant::find_body(clip, roles);
  const auto found = find_contacts(clip, roles);
  ASSERT_TRUE(body.ok() && found.ok());
  std::vector<Stay> stays;
  for (std::size_t t = 0; t < found->tracks.size(); ++t) {
    const SolePoint& point = found->tracks[t].point;
    if (point.side != FootSide::left || point.part == FootPart::heel) continue;
    const int end = point.part == FootPart::ball ? ball_leaves : tip_leaves;
    stays.push_back({.track = static_cast<int>(t), .start = 0, .end = (end - 1) / clip.rate});
  }
  ASSERT_EQ(stays.size(), 2U);
  const auto footings = plant::fix_stays(clip, *body, stays, found->tracks, {});
  const plant::FootPath path = plant::foot_path(clip, *body, body->legs[0], footings[0]);
  for (int f = 0; f < tip_leaves; ++f) {
    EXPECT_LT(std::abs(path.shift[static_cast<std::size_t>(f)].y()), 0.005) << f;
  }
}

// Feet that shake about their ankles: their points jitter, ankles and knees do not. If the ankle
// took over what the point is held by, knees would shake that were still.
TEST(PlantFeet, KneesDoNotTakeOverWhatFeetShakeBy) {
  std::mt19937 random(5);
  const auto small = [&] { return (static_cast<double>(random()) / 4294967296.0 - 0.5) * 0.05; };
  const samples::Walk walk = plain_walk();
  const RoleMap roles = find_roles(walk.clip.skeleton);
  Clip input = walk.clip;
  for (int f = 0; f < input.frame_count(); ++f) {
    for (const test::LegRoles& leg : test::legs_of(roles)) {
      const double x = small(), y = small(), z = small();
      turn_below(leg.foot, f, from_rotation_vector(Vec3(x, y, z)), input);
    }
  }
  const PlantedFeet feet = planted(input);
  const auto measures = test::measure(input, walk.clip, roles, feet.stays, feet.clip);
  EXPECT_GT(feet.drift_before, 0.005);
  EXPECT_LT(measures.drift, 0.0005);
  EXPECT_LT(measures.knee_99, 1.2);
}

// Captured knees are at times bent backwards by a few degrees. Would fail if thigh and shank turned
// over, by 180 degrees about themselves, where planting bends such a knee, or if the knee jumped
// from one side of the leg to the other.
TEST(PlantFeet, KneesBentBackwardsTurnNoLegOver) {
  const samples::Walk walk = plain_walk();
  const RoleMap roles = find_roles(walk.clip.skeleton);
  Clip input = test::with_skate(walk, {.body_jitter = 0});
  std::array<std::vector<bool>, 2> turned;  // [legs][frames]
  for (int f = 0; f < input.frame_count(); ++f) {
    for (const test::LegRoles& leg : test::legs_of(roles)) {
      auto& here = turned[leg.upper == roles.joint(Role::left_upper_leg) ? 0 : 1];
      here.push_back(false);
      const Vec3 hip = test::joint_of(input, f, leg.upper).position;
      const Vec3 knee = test::joint_of(input, f, leg.lower).position;
      const Vec3 ankle = test::joint_of(input, f, leg.foot).position;
      const Vec3 line = (ankle - hip).normalized();
      const Vec3 out = knee - hip - line * line.dot(knee - hip);
      if (out.norm() > 0.03) continue;
      here.back() = true;
      const Vec3 behind = knee - 2 * out;
      const auto turn = [&](int joint, const Vec3& from, const Vec3& to) {
        Quatf& orientation = input.frame_orientations(f)[static_cast<std::size_t>(joint)];
        orientation = (shortest_arc(from, to) * orientation.cast<double>()).cast<float>();
      };
      turn(leg.upper, knee - hip, behind - hip);
      turn(leg.lower, ankle - knee, ankle - behind);
      input.frame_positions(f)[static_cast<std::size_t>(leg.lower)] = behind.cast<float>();
    }
  }
  const PlantedFeet feet = planted(input);
  double largest = 0;
  for (int f = 0; f < input.frame_count(); ++f) {
    for (const test::LegRoles& leg : test::legs_of(roles)) {
      const Quat before = test::joint_of(input, f, leg.upper).orientation;
      const Quat after = test::joint_of(feet.clip, f, leg.upper).orientation;
      largest = std::max(largest, before.angularDistance(after));
    }
  }
  EXPECT_GT(largest, 0.05);
  EXPECT_LT(largest, 0.6);
  // Where the input does not jump.
  double jump = 0;
  for (const test::LegRoles& leg : test::legs_of(roles)) {
    const auto& here = turned[leg.upper == roles.joint(Role::left_upper_leg) ? 0 : 1];
    const auto change = [&](int f) {
      return Quat(test::joint_of(feet.clip, f, leg.lower).orientation *
                  test::joint_of(input, f, leg.lower).orientation.conjugate());
    };
    for (int f = 1; f < input.frame_count(); ++f) {
      const auto now = static_cast<std::size_t>(f);
      if (here[now] == here[now - 1])
        jump = std::max(jump, change(f).angularDistance(change(f - 1)));
    }
  }
  EXPECT_LT(jump, 0.06);
}

// All walks of the generator, at all its rates, 20 mm of slides and 5 mm of jitter.
TEST(PlantFeet, ManyWalks) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    const auto walk = samples::make_walk(test::varied_walk(seed));
    ASSERT_TRUE(walk.ok());
    const bool whole_body = seed % 2 == 0;
    const Clip input = test::with_skate(*walk, {.body_jitter = whole_body ? 0.005 : 0,
                                                .foot_jitter = whole_body ? 0 : 0.005,
                                                .seed = seed});
    const PlantedFeet feet = planted(input);
    const auto measures =
        test::measure(input, walk->clip, find_roles(input.skeleton), feet.stays, feet.clip);
    EXPECT_LT(measures.drift, 0.0005) << seed;
    EXPECT_LE(measures.knee_99, 1.2) << seed;
    EXPECT_LT(measures.stretch, 5e-6) << seed;
  }
}

TEST(PlantFeet, HeightsOverTheGroundStay) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    const auto walk = samples::make_walk(test::varied_walk(seed));
    ASSERT_TRUE(walk.ok());
    const Clip input = test::with_skate(*walk, {.body_jitter = 0, .seed = seed});
    const PlantedFeet feet = planted(input);
    const auto measures =
        test::measure(input, walk->clip, find_roles(input.skeleton), feet.stays, feet.clip);
    EXPECT_LT(measures.height, 0.001) << seed;
    EXPECT_EQ(feet.body_steadied > 0.001, false) << seed;
  }
}

TEST(PlantFeet, NothingElseMoves) {
  const Clip input = test::with_skate(plain_walk(), {.body_jitter = 0});
  const RoleMap roles = find_roles(input.skeleton);
  const PlantedFeet feet = planted(input);
  const int hips = carrying_joint(roles);
  std::vector<std::uint8_t> in_leg(input.skeleton.names.size(), 0);
  for (const test::LegRoles& leg : test::legs_of(roles)) {
    const auto below = subtree(input.skeleton, leg.upper);
    for (std::size_t j = 0; j < in_leg.size(); ++j) in_leg[j] |= below[j];
  }
  int outside = 0;
  for (std::size_t j = 0; j < in_leg.size(); ++j) {
    if (in_leg[j]) continue;
    ++outside;
    for (int f = 0; f < input.frame_count(); ++f) {
      const auto h = static_cast<std::size_t>(hips);
      EXPECT_EQ(input.frame_orientations(f)[j].coeffs(),
                feet.clip.frame_orientations(f)[j].coeffs());
      const Vec3f before = input.frame_positions(f)[j] - input.frame_positions(f)[h];
      const Vec3f after = feet.clip.frame_positions(f)[j] - feet.clip.frame_positions(f)[h];
      EXPECT_LT((before - after).norm(), 2e-6);
    }
  }
  EXPECT_GT(outside, 10);
}

// The heel comes up as it did while the ball stays where it is.
TEST(PlantFeet, RollOverTheBallStays) {
  const Clip input = test::with_skate(plain_walk(), {.body_jitter = 0});
  const PlantedFeet feet = planted(input);
  const FixedStay* heel = stay_of(feet, FootPart::heel, 20);
  ASSERT_NE(heel, nullptr);
  const FixedStay* ball = nullptr;
  for (const FixedStay& stay : feet.stays) {
    const bool same = stay.point.part == FootPart::ball && stay.point.side == heel->point.side &&
                      stay.first <= heel->last && stay.last > heel->last;
    if (same) ball = &stay;
  }
  ASSERT_NE(ball, nullptr);
  const double captured = test::place_of(input, ball->last, heel->point).y() - heel->place.y();
  const double now = test::place_of(feet.clip, ball->last, heel->point).y() - heel->place.y();
  EXPECT_GT(captured, 0.02);
  EXPECT_GT(now, captured - 0.005);
  EXPECT_LT(now, captured + 0.03);
}

// From strike to toe-off one point or another of the foot is at rest. If this fails, feet slide
// where heels come down and toes leave, which no contact covers.
TEST(PlantFeet, StancesRollFromStrikeToToeOff) {
  for (const unsigned seed : {0U, 2U, 8U, 11U}) {
    const auto walk = samples::make_walk(test::varied_walk(seed));
    ASSERT_TRUE(walk.ok());
    const Clip input = test::with_skate(*walk, {.slide = 0.04, .body_jitter = 0, .seed = seed});
    const PlantedFeet feet = planted(input);
    ASSERT_TRUE(feet.stance_share);
    EXPECT_GT(*feet.stance_share, 0.94) << seed;
    EXPECT_GT(feet.roll_before, 0.002) << seed;
    EXPECT_LT(feet.roll_after, 0.0005) << seed;
    for (const FixedStay& roll : feet.rolls) {
      Vec3 moved = test::place_of(feet.clip, roll.last, roll.point) -
                   test::place_of(feet.clip, roll.first, roll.point);
      moved.y() = 0;
      EXPECT_LT(moved.norm(), 0.0005) << seed << " " << roll.first;
    }
  }
}

// In a run, feet that come down and leave fast are not held where they move.
TEST(PlantFeet, RollsEndWhereAFootMoves) {
  samples::WalkOptions options;
  options.steps = 6;
  const samples::Walk walk = samples::make_walk(options).value();
  const PlantedFeet feet = planted(test::with_skate(walk, {.slide = 0.1, .body_jitter = 0}));
  for (const FixedStay& roll : feet.rolls) EXPECT_LT(roll.drift_before, 0.08);
  EXPECT_LT(feet.pelvis_lowered, 0.1);
}

TEST(PlantFeet, SkeletonsWithoutToes) {
  const Clip whole = test::with_skate(plain_walk(), {});
  for (const std::vector<std::string>& dropped :
       {std::vector<std::string>{"ToeBase_end"}, std::vector<std::string>{"ToeBase"}}) {
    const Clip input = test::without(whole, dropped);
    const PlantedFeet feet = planted(input);
    const auto measures =
        test::measure(input, input, find_roles(input.skeleton), feet.stays, feet.clip);
    EXPECT_GE(measures.stays, 12) << dropped[0];
    EXPECT_LT(measures.drift, 0.0005) << dropped[0];
    EXPECT_LE(measures.knee_99, 1.2) << dropped[0];
  }
}

TEST(PlantFeet, ContactsGivenDecide) {
  const Clip input = test::with_skate(plain_walk(), {.body_jitter = 0});
  const RoleMap roles = find_roles(input.skeleton);
  const int toes = roles.joints(Role::left_toes).front();
  const std::vector<Contact> contacts = {{toes, 1.0, 1.2, Vec3::Zero()},
                                         {roles.joint(Role::left_hand), 0.2, 0.9, Vec3::Zero()}};
  const PlantedFeet feet = planted(input, contacts);
  int balls = 0;
  for (const FixedStay& stay : feet.stays) {
    if (stay.point.joint != toes || stay.point.part != FootPart::ball) continue;
    ++balls;
    EXPECT_EQ(stay.first, 60);
    EXPECT_EQ(stay.last, 72);
    EXPECT_LT(stay.drift_after, 0.0005);
  }
  EXPECT_EQ(balls, 1);
  for (const FixedStay& stay : feet.stays) EXPECT_EQ(stay.point.side, FootSide::left);
  // What one short contact leaves as captured is not passed over.
  const PlantedFeet all = planted(input);
  ASSERT_TRUE(feet.stance_share && all.stance_share);
  EXPECT_LT(*feet.stance_share, 0.4);
  EXPECT_GT(*all.stance_share, 0.6);
  EXPECT_LE(*all.stance_share, 1);
}

// A leg that is straight already, and whose foot is to stand behind where it is: the pelvis comes
// down, the leg keeps its length.
TEST(PlantFeet, PelvisIsLoweredBeforeALegIsStretched) {
  samples::WalkOptions options;
  options.steps = 6;
  options.step_length = 0.9;
  const samples::Walk walk = samples::make_walk(options).value();
  const Clip input = test::with_skate(walk, {.slide = 0.1, .body_jitter = 0});
  const PlantedFeet feet = planted(input);
  EXPECT_GT(feet.pelvis_lowered, 0.001);
  EXPECT_EQ(feet.out_of_reach, 0);
  EXPECT_LT(feet.drift_after, 0.0005);
  const auto measures =
      test::measure(input, walk.clip, find_roles(input.skeleton), feet.stays, feet.clip);
  EXPECT_LT(measures.stretch, 5e-6);
}

// A cartwheel: a leg that is level or up, and its foot corrected away from the hip. Would fail if
// the pelvis went down for it, which brings no such foot nearer: hands went 11 cm into the ground.
TEST(PlantFeet, PelvisIsNotLoweredForAFootInTheAir) {
  Clip clip;
  clip.skeleton = test::human_skeleton();
  clip.resize(3);
  const RoleMap roles = find_roles(clip.skeleton);
  const auto body = plant::find_body(clip, roles);
  ASSERT_TRUE(body.ok());
  const int thigh = roles.joint(Role::left_upper_leg);
  const auto lowered = [&](double degrees) {
    std::vector<plant::FootPath> paths(body->legs.size());
    for (auto& path : paths) path.turn = path.shift = std::vector<Vec3>(3, Vec3::Zero());
    for (int f = 0; f < 3; ++f) {
      clip.set_pose(f, clip.skeleton.reference);
      turn_below(thigh, f, from_rotation_vector(Vec3(0, 0, degrees * kRadiansPerDegree)), clip);
      const Vec3 leg = test::joint_of(clip, f, body->legs[0].foot).position -
                       test::joint_of(clip, f, thigh).position;
      paths[0].shift[static_cast<std::size_t>(f)] = 0.02 * leg.normalized();
    }
    return std::ranges::max(plant::lowering(clip, *body, paths));
  };
  EXPECT_NEAR(lowered(20), 0.02 / std::cos(20 * kRadiansPerDegree), 0.01);
  for (const double degrees : {70, 80, 88, 92, 120, 180})
    EXPECT_LT(lowered(degrees), 1e-6) << degrees;
}

// A rest pose before the capture stands elsewhere; drawn there, the foot would tear the leg.
TEST(PlantFeet, ARestPoseInTheFirstFrameIsLeftAlone) {
  Clip input = test::with_skate(plain_walk(), {.body_jitter = 0});
  std::vector<Transform> rest = input.skeleton.reference;
  for (Transform& joint : rest) joint.position += Vec3(2, 0, 1);
  input.set_pose(0, rest);
  const PlantedFeet feet = planted(input);
  for (const FixedStay& stay : feet.stays) EXPECT_GT(stay.first, 0);
  for (std::size_t j = 0; j < rest.size(); ++j) {
    EXPECT_LT((feet.clip.frame_positions(0)[j] - input.frame_positions(0)[j]).norm(), 0.05);
  }
}

// The foot cannot stay for so long; what is far from the place is left out, and no leg is torn.
TEST(PlantFeet, AContactOverAllStepsTearsNoLeg) {
  const Clip input = plain_walk().clip;
  const int toes = find_roles(input.skeleton).joints(Role::left_toes).front();
  const std::vector<Contact> contacts = {{toes, 0, input.duration(), Vec3::Zero()}};
  const auto result = plant_feet(input, find_roles(input.skeleton), contacts);
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(check(result->clip).ok());
  for (const FixedStay& stay : result->stays) {
    EXPECT_LT(stay.last - stay.first, input.frame_count() - 1);
  }
  const auto measures = test::measure(input, input, find_roles(input.skeleton), {}, result->clip);
  EXPECT_LT(measures.stretch, 5e-6);
}

TEST(PlantFeet, Errors) {
  const Clip walk = plain_walk().clip;
  const auto code = [](const Clip& clip, std::optional<std::span<const Contact>> contacts = {}) {
    const auto result = plant_feet(clip, find_roles(clip.skeleton), contacts);
    return result.ok() ? std::string() : result.error().code;
  };
  EXPECT_EQ(code(test::without(walk, {"Leg", "Foot", "Toe"})), "contacts-feet");
  EXPECT_EQ(code(test::without(walk, {"RightLeg", "LeftLeg", "Foot", "Toe"})), "contacts-feet");
  const std::vector<Contact> of_hand = {{walk.skeleton.find("LeftHand"), 0, 1, Vec3::Zero()}};
  EXPECT_EQ(code(walk, of_hand), "plant-contacts");
  EXPECT_EQ(code(walk, std::span<const Contact>()), "plant-contacts");
  Clip flying = walk;
  for (int f = 0; f < flying.frame_count(); ++f) {
    for (Vec3f& position : flying.frame_positions(f)) position += Vec3f(0, 0, 0.1F * f);
  }
  EXPECT_EQ(code(flying), "plant-contacts");
  Clip hurt = walk;
  hurt.positions[500].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code(hurt), "clip-value");
  Clip empty = walk;
  empty.resize(0);
  EXPECT_EQ(code(empty), "plant-contacts");
}

}  // namespace
}  // namespace krok
