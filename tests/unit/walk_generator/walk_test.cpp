// If these fail, the generated walks are no ground truth: feet slide in what is called a contact,
// sink into the ground, steps are not as long as asked for, or the figure no longer walks like a
// person.

#include "samples/generator/walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"
#include "measure.h"
#include "samples/generator/gait_curves.h"

namespace krok::samples {
namespace {

WalkOptions walk(double step_length, double turn_degrees = 0, double rise = 0,
                 bool from_standing = false) {
  WalkOptions options;
  options.steps = 6;
  options.step_length = step_length;
  options.turn = turn_degrees * kRadiansPerDegree;
  options.rise = rise;
  options.from_standing = from_standing;
  return options;
}

struct Case {
  const char* name;
  WalkOptions options;
};

std::vector<Case> cases() {
  std::vector<Case> list = {{"ordinary", walk(0.7)},
                            {"standing", walk(0.7, 0, 0, true)},
                            {"long_steps", walk(0.9)},
                            {"in_place", walk(0, 0, 0, true)},
                            {"left_turn", walk(0.65, 15)},
                            {"sharp_right_turn", walk(0.6, -30)},
                            {"turn_on_the_spot", walk(0.1, 40, 0, true)},
                            {"upstairs", walk(0.32, 0, 0.16, true)},
                            {"downstairs", walk(0.32, 0, -0.16, true)},
                            {"uphill", walk(0.6, 0, 0.06)},
                            {"downhill", walk(0.6, 0, -0.06)},
                            {"steeply_downhill", walk(0.65, 0, -0.12)},
                            {"turning_uphill", walk(0.5, 20, 0.12)},
                            {"turning_downhill", walk(0.5, 20, -0.12)},
                            {"child", walk(0.5)},
                            {"slow_and_fine", walk(0.5)}};
  for (std::size_t i = 9; i < 14; ++i) list[i].options.ground = Ground::slope;
  list[14].options.stature = 1.2;
  list[15].options.cadence = 60;
  list[15].options.rate = 240;
  list[15].options.first_side = Side::right;
  list[15].options.step_width = 0.2;
  return list;
}

class AnyWalk : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    Result<Walk> made = make_walk(GetParam().options);
    ASSERT_TRUE(made.ok()) << made.error().message;
    walk_ = std::move(*made);
  }
  Walk walk_;
};

INSTANTIATE_TEST_SUITE_P(Kinds, AnyWalk, testing::ValuesIn(cases()),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST_P(AnyWalk, IsAValidClip) {
  EXPECT_TRUE(check(walk_.clip).ok());
  EXPECT_GT(walk_.clip.frame_count(), 60);
}

TEST_P(AnyWalk, BonesKeepTheirLengths) {
  for (int frame = 0; frame < walk_.clip.frame_count(); frame += 5) {
    const auto positions = walk_.clip.frame_positions(frame);
    for (int joint = 1; joint < walk_.clip.joint_count(); ++joint) {
      const auto parent = static_cast<std::size_t>(walk_.clip.skeleton.parents[joint]);
      const double length =
          (positions[static_cast<std::size_t>(joint)] - positions[parent]).cast<double>().norm();
      EXPECT_NEAR(length, walk_.clip.skeleton.reference_local(joint).position.norm(), 2e-6);
    }
  }
}

TEST_P(AnyWalk, ContactPointsStayPut) {
  int checked = 0;
  for (const Side side : {Side::left, Side::right}) {
    const std::string name = test::joint_side(side);
    const FootContacts& foot = walk_.feet[static_cast<std::size_t>(side)];
    const auto expect_still = [&](const std::vector<Contact>& contacts,
                                  const std::vector<Vec3>& at) {
      for (const Contact& contact : contacts) {
        for (int frame = 0; frame < walk_.clip.frame_count(); ++frame) {
          const double time = frame / walk_.clip.rate;
          if (time < contact.from || time > contact.to) continue;
          // A twentieth of a millimetre, from float positions and slopes at an angle to the foot.
          EXPECT_LT((at[static_cast<std::size_t>(frame)] - contact.place).norm(), 5e-5)
              << name << " frame " << frame;
          ++checked;
        }
      }
    };
    expect_still(foot.heel, test::track(walk_.clip, name + "Foot", walk_.actor.heel));
    expect_still(foot.toe, test::track(walk_.clip, name + "ToeBase",
                                       walk_.actor.toe_tip - walk_.actor.toe_joint));
  }
  EXPECT_GT(checked, walk_.clip.frame_count());
}

TEST_P(AnyWalk, FeetNeverSinkIntoTheGround) {
  const FootPlan plan = plan_feet(walk_.options, walk_.actor);
  // Each footprint lies in a plane of its own: where a slope turns, planes meet in an edge of 4 mm.
  const bool has_edges = walk_.options.ground == Ground::slope && walk_.options.turn != 0;
  const double lowest = has_edges ? -5e-3 : -5e-4;
  for (const Side side : {Side::left, Side::right}) {
    const std::string name = test::joint_side(side);
    const Vec3 toe = walk_.actor.toe_joint;
    for (const auto& points :
         {test::track(walk_.clip, name + "Foot", walk_.actor.heel),
          test::track(walk_.clip, name + "ToeBase", walk_.actor.ball - toe),
          test::track(walk_.clip, name + "ToeBase", walk_.actor.toe_tip - toe)}) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_GT(points[i].y() - plan.ground_height(points[i]), lowest) << name << " frame " << i;
      }
    }
  }
}

// No one lifts a foot to the height of the hips to walk. Would fail where toes that are 4 mm in the
// ground as they leave it raise the foot by metres, and legs turn over.
TEST_P(AnyWalk, FeetAreLiftedNoHigherThanTheyNeed) {
  const FootPlan plan = plan_feet(walk_.options, walk_.actor);
  const double most = 0.2 * walk_.actor.stature + std::abs(walk_.options.rise);
  for (const Side side : {Side::left, Side::right}) {
    const auto heels =
        test::track(walk_.clip, std::string(test::joint_side(side)) + "Foot", walk_.actor.heel);
    for (std::size_t i = 0; i < heels.size(); ++i) {
      EXPECT_LT(heels[i].y() - plan.ground_height(heels[i]), most) << "frame " << i;
    }
  }
}

TEST_P(AnyWalk, KneesNeitherLockNorSnap) {
  for (const Side side : {Side::left, Side::right}) {
    const test::LegAngles angles = test::leg_angles(walk_.clip, side);
    EXPECT_EQ(angles.hyperextension, 0);
    EXPECT_GT(*std::min_element(angles.knee.begin(), angles.knee.end()), 2.5 * kRadiansPerDegree);
    EXPECT_LT(*std::max_element(angles.knee.begin(), angles.knee.end()), 110 * kRadiansPerDegree);
    for (std::size_t i = 2; i < angles.knee.size(); ++i) {
      const double acceleration = (angles.knee[i] - 2 * angles.knee[i - 1] + angles.knee[i - 2]) *
                                  walk_.clip.rate * walk_.clip.rate;
      EXPECT_LT(std::abs(acceleration), 30000 * kRadiansPerDegree) << "frame " << i;
    }
  }
}

TEST_P(AnyWalk, StepsAreAsAskedFor) {
  int checked = 0;
  for (std::size_t i = 1; i < walk_.prints.size(); ++i) {
    const Footprint& from = walk_.prints[i - 1];
    const Footprint& to = walk_.prints[i];
    EXPECT_NE(from.side, to.side);
    const bool standing = to.first_of_foot || (to.last_of_foot && to.step_length == 0);
    if (walk_.options.from_standing && standing) continue;
    // From the heels' own places: each half the step's width beside the midline.
    const auto midline = [&](const Footprint& print) {
      return Vec3(print.heel - left_of(print.path_heading) *
                                   (side_sign(print.side) * 0.5 * walk_.options.step_width));
    };
    const Vec3 step = midline(to) - midline(from);
    EXPECT_NEAR(Vec2(step.x(), step.z()).norm(), walk_.options.step_length, 1e-9);
    EXPECT_NEAR(step.y(), walk_.options.rise, 1e-9);
    EXPECT_NEAR(to.path_heading - from.path_heading, walk_.options.turn, 1e-9);
    EXPECT_NEAR(to.strike - from.strike, walk_.step_time, 1e-9);
    ++checked;
  }
  EXPECT_GE(checked, walk_.options.steps - 1);
}

TEST_P(AnyWalk, StrikesAndOffsAlternate) {
  std::size_t strikes = 0;
  for (const FootContacts& foot : walk_.feet) {
    strikes += foot.strikes.size();
    std::vector<std::pair<double, bool>> events;
    for (double time : foot.strikes) events.emplace_back(time, true);
    for (double time : foot.offs) events.emplace_back(time, false);
    std::sort(events.begin(), events.end());
    for (std::size_t i = 1; i < events.size(); ++i)
      EXPECT_NE(events[i].second, events[i - 1].second);
  }
  // The strike that precedes the first step counts where it is in the clip; a walk that ends
  // standing brings the last foot beside the other.
  EXPECT_EQ(strikes, static_cast<std::size_t>(walk_.options.steps) + 1);
}

// Values over a stride of the left foot, evenly spaced, the first at the strike.
std::vector<double> over_stride(const Walk& made, const std::vector<double>& values, int count) {
  const double start = made.feet[0].strikes[0];
  const double stride = 2 * made.step_time;
  std::vector<double> result;
  for (int i = 0; i < count; ++i) {
    const double at = (start + stride * i / count) * made.clip.rate;
    const auto frame = static_cast<std::size_t>(at);
    const double part = at - static_cast<double>(frame);
    result.push_back(values[frame] * (1 - part) + values[frame + 1] * part);
  }
  return result;
}

TEST(OrdinaryWalk, TheLegsMoveAsPublished) {
  const Result<Walk> made = make_walk(walk(0.7));
  ASSERT_TRUE(made.ok());
  const test::LegAngles angles = test::leg_angles(made->clip, Side::left);
  const auto range = [](const std::vector<double>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return std::pair(*low / kRadiansPerDegree, *high / kRadiansPerDegree);
  };
  // Perry and Burnfield; Winter: thigh about -20 to 25, with the pelvis's rotation a little more.
  EXPECT_NEAR(range(angles.hip).first, -20, 6);
  EXPECT_NEAR(range(angles.hip).second, 30, 9);
  EXPECT_NEAR(range(angles.knee).first, 4, 3);
  EXPECT_NEAR(range(angles.knee).second, 62, 9);
  EXPECT_NEAR(range(angles.ankle).first, -20, 8);
  EXPECT_NEAR(range(angles.ankle).second, 12, 7);

  const std::vector<double> knee = over_stride(*made, angles.knee, 40);
  double sum = 0;
  for (int i = 0; i < 40; ++i) {
    const double difference = knee[static_cast<std::size_t>(i)] - knee_flexion(i / 40.0);
    sum += difference * difference;
  }
  EXPECT_LT(std::sqrt(sum / 40), 6 * kRadiansPerDegree) << "the knee's curve over the stride";
}

TEST(OrdinaryWalk, ThePelvisRisesTwiceAStride) {
  const Result<Walk> made = make_walk(walk(0.7));
  ASSERT_TRUE(made.ok());
  std::vector<double> height;
  for (const Vec3& place : test::track(made->clip, "Hips", Vec3::Zero()))
    height.push_back(place.y());
  const std::vector<double> stride = over_stride(*made, height, 60);
  int peaks = 0;
  for (std::size_t i = 0; i < stride.size(); ++i) {
    const double before = stride[(i + 59) % 60], after = stride[(i + 1) % 60];
    if (stride[i] > before && stride[i] >= after) ++peaks;
  }
  EXPECT_EQ(peaks, 2);
  const auto [low, high] = std::minmax_element(stride.begin(), stride.end());
  EXPECT_GT(*high - *low, 0.02);
  EXPECT_LT(*high - *low, 0.06);
}

TEST(OrdinaryWalk, ArmsSwingAgainstTheLegs) {
  const Result<Walk> made = make_walk(walk(0.7));
  ASSERT_TRUE(made.ok());
  const auto hips = test::track(made->clip, "Hips", Vec3::Zero());
  const auto hand = test::track(made->clip, "LeftHand", Vec3::Zero());
  const auto ankle = test::track(made->clip, "LeftFoot", Vec3::Zero());
  double product = 0, hands = 0, ankles = 0;
  double low = 1, high = -1;
  for (std::size_t i = 0; i < hips.size(); ++i) {
    const double h = hand[i].z() - hips[i].z(), a = ankle[i].z() - hips[i].z();
    low = std::min(low, h);
    high = std::max(high, h);
    product += (h - 0.1) * a;
    hands += (h - 0.1) * (h - 0.1);
    ankles += a * a;
  }
  EXPECT_LT(product / std::sqrt(hands * ankles), -0.6);
  EXPECT_GT(high - low, 0.25);
}

TEST(WalkOptionsCheck, WhatIsOutOfRangeIsRefused) {
  const auto refused = [](auto change) {
    WalkOptions options;
    change(options);
    const Result<Walk> made = make_walk(options);
    return !made.ok() && made.error().code == "walk-option" && !made.error().hint.empty();
  };
  EXPECT_TRUE(refused([](WalkOptions& o) { o.steps = 0; }));
  EXPECT_TRUE(refused([](WalkOptions& o) { o.step_length = 1.5; }));
  EXPECT_TRUE(refused([](WalkOptions& o) { o.step_length = -0.1; }));
  EXPECT_TRUE(refused([](WalkOptions& o) { o.stature = std::nan(""); }));
  EXPECT_TRUE(refused([](WalkOptions& o) { o.rate = 0; }));
  EXPECT_TRUE(refused([](WalkOptions& o) { o.cadence = 5; }));
  EXPECT_TRUE(refused([](WalkOptions& o) { o.turn = 2; }));
  EXPECT_TRUE(refused([](WalkOptions& o) { o.rise = 0.1, o.step_length = 0.1; }));
  EXPECT_FALSE(refused([](WalkOptions&) {}));
}

TEST(Noise, HasTheDeviationAskedForAndComesFromTheSeed) {
  WalkOptions options = walk(0.7);
  const Result<Walk> clean = make_walk(options);
  options.noise_angle = 0.5 * kRadiansPerDegree;
  options.noise_position = 0.002;
  const Result<Walk> noisy = make_walk(options);
  const Result<Walk> again = make_walk(options);
  options.seed = 2;
  const Result<Walk> other_seed = make_walk(options);
  ASSERT_TRUE(clean.ok() && noisy.ok() && again.ok() && other_seed.ok());
  EXPECT_EQ(noisy->clip.positions, again->clip.positions);
  EXPECT_NE(noisy->clip.positions, other_seed->clip.positions);
  double position = 0, angle = 0;
  const int frames = clean->clip.frame_count();
  for (int frame = 0; frame < frames; ++frame) {
    position += (noisy->clip.frame_positions(frame)[0] - clean->clip.frame_positions(frame)[0])
                    .cast<double>()
                    .squaredNorm();
    const double turned = angle_between(noisy->clip.frame_orientations(frame)[0].cast<double>(),
                                        clean->clip.frame_orientations(frame)[0].cast<double>());
    angle += turned * turned;
  }
  // Three components each.
  EXPECT_NEAR(std::sqrt(position / frames / 3), 0.002, 0.0003);
  EXPECT_NEAR(std::sqrt(angle / frames / 3), 0.5 * kRadiansPerDegree, 0.08 * kRadiansPerDegree);
}

}  // namespace
}  // namespace krok::samples
