// If these fail, feet of a retargeted walk slide, float or sink, or knees bend the wrong way.

#include <gtest/gtest.h>

#include <algorithm>

#include "ik/soft_reach.h"
#include "math/window.h"
#include "retarget/foot_placement.h"
#include "samples/generator/walk.h"
#include "tests/unit/retarget/actors.h"

namespace krok {
namespace {

using namespace test;

samples::Walk walk_of(samples::WalkOptions options) {
  options.steps = 6;
  auto walk = samples::make_walk(options);
  EXPECT_TRUE(walk.ok());
  return std::move(*walk);
}

// A file may claim any rate; the frames that are looked at must not grow with it.
TEST(Softening, ReachesAsFarAsTheRateAllows) {
  EXPECT_EQ(softening_reach(100), 12);
  EXPECT_EQ(softening_reach(1e11), 256);
  EXPECT_EQ(softening_reach(1e-9), 0);
  const std::vector<double> values = {0, 0, 0, 1, 0, 0, 0, 0};
  const auto soft = softened(values, 2);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_GE(soft[i], values[i] - 1e-12) << i;
  EXPECT_NEAR(soft[3], 1, 1e-12);
  EXPECT_EQ(softened({}, 256).size(), 0u);
}

// A figure of other proportions: `thigh`, `shank`, `foot` and `width` times those of a human.
Skeleton actor_of(double stature, double thigh, double shank, double foot, double width) {
  Skeleton skeleton = human_skeleton(stature);
  const auto place = [&](const std::string& name) -> Vec3& {
    return skeleton.reference[at(skeleton.find(name))].position;
  };
  for (const std::string side : {"Left", "Right"}) {
    const Vec3 hip = place(side + "UpLeg"), knee = place(side + "Leg"),
               ankle = place(side + "Foot"), ball = place(side + "ToeBase"),
               tip = place(side + "ToeBase_end");
    place(side + "UpLeg").x() *= width;
    place(side + "Leg") = place(side + "UpLeg") + thigh * (knee - hip);
    place(side + "Foot") = place(side + "Leg") + shank * (ankle - knee);
    place(side + "ToeBase") = place(side + "Foot") + Vec3(1, 1, foot).cwiseProduct(ball - ankle);
    place(side + "ToeBase_end") =
        place(side + "ToeBase") + Vec3(1, 1, foot).cwiseProduct(tip - ball);
  }
  return with_other_axes(skeleton, 11);
}

// Captures have reference poses with legs spread by 20 degrees and the feet tilted with them. Feet
// headed inwards by 14 degrees on rigs whose legs are upright there.
TEST(Feet, LegsSpreadInTheReferencePoseDoNotTurnFeet) {
  const samples::Walk walk = walk_of({});
  for (const double angle : {10.0, 20.0, 30.0}) {
    Clip spread = walk.clip;
    for (const double sign : {1.0, -1.0}) {
      spread.skeleton = posed(spread.skeleton, sign > 0 ? "LeftUpLeg" : "RightUpLeg",
                              from_rotation_vector(Vec3(0, 0, sign * angle * kRadiansPerDegree)));
    }
    const auto made = transfer(spread, with_other_axes(walk.clip.skeleton, 4), {.scale = 1});
    ASSERT_TRUE(made.ok());
    for (const std::string side : {"Left", "Right"}) {
      const auto heading = [&](const Clip& clip, int frame, const std::string& prefix) {
        const auto place = [&](const char* joint) {
          const int index = clip.skeleton.find(prefix + side + joint);
          return Vec3(clip.frame_positions(frame)[at(index)].cast<double>());
        };
        const Vec3 foot = place("ToeBase") - place("Foot");
        return std::atan2(foot.x(), foot.z()) / kRadiansPerDegree;
      };
      double mean = 0;
      for (int f = 0; f < walk.clip.frame_count(); ++f) {
        mean += std::abs(heading(made->clip, f, "rig:") - heading(walk.clip, f, "")) /
                walk.clip.frame_count();
      }
      EXPECT_LT(mean, 2) << side << angle;
    }
  }
}

// Rigs have ankles as low as the toes, or as high as in people. Would fail if the bone of a foot
// that stands were turned to the other's pitch, and its sole with it.
TEST(Feet, AnkleHeightsDoNotTiltSoles) {
  Clip standing = resting(actor_of(1.8, 1, 1, 0.5, 1));
  standing.rate = 30;
  standing.resize(2);
  for (int f = 0; f < 2; ++f) standing.set_pose(f, standing.skeleton.reference);
  Skeleton low = human_skeleton(1.7);
  for (const std::string side : {"Left", "Right"}) {
    const double ball = low.reference[at(low.find(side + "ToeBase"))].position.y();
    low.reference[at(low.find(side + "Foot"))].position.y() = ball;
  }
  const auto made = transfer(standing, low);
  ASSERT_TRUE(made.ok());
  for (const std::string side : {"Left", "Right"}) {
    EXPECT_LT(std::abs(bone(made->clip, 0, side + "Foot", side + "ToeBase").y()), 0.02) << side;
  }
}

// Old men, apes and monsters stoop in their reference poses, over legs that are upright. If this
// fails, their soles are pitched by what the trunk is turned, toes up; or those of a body that
// leans as a whole are not turned with it.
TEST(Feet, ATrunkThatStoopsDoesNotTiltSoles) {
  Clip standing = resting(human_skeleton(1.8));
  standing.rate = 30;
  standing.resize(2);
  for (int f = 0; f < 2; ++f) standing.set_pose(f, standing.skeleton.reference);
  const auto pitch = [](const Clip& clip, const std::string& foot, const std::string& toes) {
    return std::asin(bone(clip, 0, foot, toes).y()) / kRadiansPerDegree;
  };
  for (const double angle : {-30, 20, 30, 45}) {
    const Quat lean = from_rotation_vector(angle * kRadiansPerDegree * Vec3::UnitX());
    const Skeleton leaning = posed(human_skeleton(1.7), "Hips", lean);
    const Skeleton stooping =
        posed(posed(leaning, "LeftUpLeg", lean.conjugate()), "RightUpLeg", lean.conjugate());
    const auto expect_flat = [&](const Skeleton& target, const char* what) {
      const auto made = transfer(standing, with_other_axes(target, 5));
      ASSERT_TRUE(made.ok());
      for (const std::string side : {"Left", "Right"}) {
        const std::string foot = side + "Foot", toes = side + "ToeBase";
        EXPECT_NEAR(pitch(made->clip, "rig:" + foot, "rig:" + toes), pitch(standing, foot, toes), 1)
            << what << " by " << angle << ", " << side;
      }
    };
    expect_flat(stooping, "stooping");
    if (angle > 35) expect_flat(leaning, "leaning");  // less is build in part
  }
}

// How far a joint of the foot moves over the ground while it should stand there, the first and last
// hundredth of a second of each contact apart.
double slide_of(const Clip& clip, const std::string& joint,
                const std::vector<samples::Contact>& contacts) {
  const int j = clip.skeleton.find(joint);
  double most = 0;
  for (const samples::Contact& contact : contacts) {
    Eigen::AlignedBox3d box;
    for (int f = 0; f < clip.frame_count(); ++f) {
      const double time = f / clip.rate;
      if (time < contact.from + 0.01 || time > contact.to - 0.01) continue;
      Vec3 place = clip.frame_positions(f)[at(j)].cast<double>();
      place.y() = 0;
      box.extend(place);
    }
    if (!box.isEmpty()) most = std::max(most, box.diagonal().norm());
  }
  return most;
}

double lowest_of(const Clip& clip) {
  double lowest = 1e9;
  for (const Vec3f& position : clip.positions) lowest = std::min<double>(lowest, position.y());
  return lowest;
}

// Largest angle in degrees by which a knee bends against its sense, the figure facing its toes.
double backward_bend(const Clip& clip, const std::string& prefix = "rig:") {
  double most = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (const std::string side : {"Left", "Right"}) {
      const Vec3 thigh = bone(clip, f, prefix + side + "UpLeg", prefix + side + "Leg");
      const Vec3 shank = bone(clip, f, prefix + side + "Leg", prefix + side + "Foot");
      const Vec3 left = bone(clip, f, prefix + "RightUpLeg", prefix + "LeftUpLeg");
      const double bend = std::atan2(thigh.cross(shank).dot(left), thigh.dot(shank));
      most = std::max(most, -bend / kRadiansPerDegree);
    }
  }
  return most;
}

struct Proportions {
  const char* name;
  double stature, thigh, shank, foot, width;
};
constexpr Proportions kFigures[] = {{"tall", 1.95, 1, 1, 1, 1},
                                    {"small_with_long_thighs", 1.3, 1.12, 0.95, 1, 1},
                                    {"long_shanks_and_feet", 1.75, 0.92, 1.1, 1.35, 1},
                                    {"broad_with_short_feet", 1.7, 1, 1, 0.7, 1.5},
                                    {"narrow", 1.8, 1.05, 0.97, 1.1, 0.7}};

class FeetOf : public testing::TestWithParam<Proportions> {};

TEST_P(FeetOf, StandWhereTheSourceStands) {
  const Proportions& p = GetParam();
  const Skeleton target = actor_of(p.stature, p.thigh, p.shank, p.foot, p.width);
  samples::WalkOptions turning;
  turning.turn = 0.2;
  samples::WalkOptions stairs;
  stairs.rise = 0.12;
  for (const samples::WalkOptions& options : {samples::WalkOptions(), turning, stairs}) {
    const samples::Walk walk = walk_of(options);
    const auto result = transfer(walk.clip, target);
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result->report.method, retarget::Method::roles);
    for (const int side : {0, 1}) {
      const std::string name = side == 0 ? "Left" : "Right";
      const auto& contacts = walk.feet[at(side)];
      // The ball stands while the tip of the toes does, the ankle while heel and toes do.
      std::vector<samples::Contact> flat;
      for (const samples::Contact& heel : contacts.heel) {
        for (const samples::Contact& toe : contacts.toe) {
          samples::Contact both = heel;
          both.from = std::max(heel.from, toe.from);
          both.to = std::min(heel.to, toe.to);
          if (both.to > both.from) flat.push_back(both);
        }
      }
      ASSERT_FALSE(flat.empty());
      EXPECT_LT(slide_of(result->clip, "rig:" + name + "Foot", flat), 0.005);
      // Over its tip the ball rolls in the source too.
      const double rolls = slide_of(walk.clip, name + "ToeBase", contacts.toe);
      EXPECT_LT(slide_of(result->clip, "rig:" + name + "ToeBase", contacts.toe),
                result->report.scale * rolls + 0.005);
    }
    // No deeper than the source itself, whose toes bend over the floor.
    const double scale = result->report.scale;
    EXPECT_GT(lowest_of(result->clip), scale * std::min(0.0, lowest_of(walk.clip)) - 0.003);
    EXPECT_LT(lowest_of(result->clip), 0.03);
    EXPECT_LT(backward_bend(result->clip), std::max(1.0, backward_bend(walk.clip, "") + 1));
    ASSERT_TRUE(result->report.left_foot && result->report.right_foot);
    EXPECT_LT(result->report.left_foot->largest_miss, 0.02);
  }
}

INSTANTIATE_TEST_SUITE_P(Actors, FeetOf, testing::ValuesIn(kFigures),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

// Heels and balls that stand as the foot rolls over them: whatever stands in the source stands in
// the target, though its ankles and toes are of another height.
TEST(Feet, RollOverHeelAndBallWhateverTheHeightOfTheirJoints) {
  const samples::Walk walk = walk_of({});
  for (const double higher : {0.03, -0.015}) {
    Skeleton target = actor_of(1.6, 1, 1, 1.25, 1);
    for (const std::string side : {"Left", "Right"}) {
      for (const char* joint : {"Foot", "ToeBase"}) {
        target.reference[at(target.find("rig:" + side + joint))].position.y() += higher;
      }
    }
    const auto result = transfer(walk.clip, target);
    ASSERT_TRUE(result.ok());
    int standing = 0;
    for (const retarget::ContactReport& contact : result->report.contacts) {
      if (contact.on != "ground" || contact.end - contact.start < 0.1) continue;
      ++standing;
      EXPECT_LT(contact.slide, result->report.scale * contact.source_slide + 0.006)
          << contact.part << " " << contact.start << " " << higher;
    }
    EXPECT_GE(standing, 8);
  }
}

// Captures turn a straight thigh about itself at will, which no joint's place shows: knees of the
// target do not follow it.
TEST(Feet, ATurnOfTheThighAboutItselfDoesNotTurnTheKnee) {
  const samples::Walk walk = walk_of({});
  Clip turned = walk.clip;
  std::vector<Transform> pose(turned.skeleton.names.size());
  for (int f = 0; f < turned.frame_count(); ++f) {
    turned.get_pose(f, pose);
    for (const std::string side : {"Left", "Right"}) {
      Transform& thigh = pose[at(turned.skeleton.find(side + "UpLeg"))];
      const Vec3 bone = pose[at(turned.skeleton.find(side + "Leg"))].position - thigh.position;
      thigh.orientation = from_rotation_vector(std::sin(40 * f / turned.rate) * bone.normalized()) *
                          thigh.orientation;
    }
    turned.set_pose(f, pose);
  }
  const Skeleton target = actor_of(1.75, 0.92, 1.1, 1.35, 1);
  const auto plain = transfer(walk.clip, target), other = transfer(turned, target);
  ASSERT_TRUE(plain.ok() && other.ok());
  for (const char* knee : {"rig:LeftLeg", "rig:RightLeg"}) {
    const std::size_t j = at(target.find(knee));
    for (int f = 0; f < turned.frame_count(); ++f) {
      const Vec3f apart = other->clip.frame_positions(f)[j] - plain->clip.frame_positions(f)[j];
      EXPECT_LT(apart.norm(), 0.002) << knee << " " << f;
    }
  }
}

TEST(Feet, LeftFreeTheySlideWhichShowsThatTheTestCanFail) {
  const samples::Walk walk = walk_of({});
  const Skeleton target = actor_of(1.75, 0.92, 1.1, 1.35, 1);
  const auto result = transfer(walk.clip, target, {.feet = retarget::Feet::free});
  ASSERT_TRUE(result.ok());
  EXPECT_FALSE(result->report.left_foot.has_value());
  EXPECT_GT(slide_of(result->clip, "rig:LeftToeBase", walk.feet[0].toe),
            slide_of(walk.clip, "LeftToeBase", walk.feet[0].toe) + 0.01);
}

TEST(Feet, TheMotionHasNoJumps) {
  const samples::Walk walk = walk_of({});
  const auto result = transfer(walk.clip, actor_of(1.75, 0.92, 1.1, 1.35, 1));
  ASSERT_TRUE(result.ok());
  // Accelerations of ankles and knees stay near those of the source.
  const auto largest_jerk = [](const Clip& clip, const std::string& joint) {
    const int j = clip.skeleton.find(joint);
    double most = 0;
    for (int f = 1; f + 1 < clip.frame_count(); ++f) {
      const Vec3f second = clip.frame_positions(f - 1)[at(j)] - 2 * clip.frame_positions(f)[at(j)] +
                           clip.frame_positions(f + 1)[at(j)];
      most = std::max<double>(most, second.norm());
    }
    return most;
  };
  for (const std::string joint : {"LeftLeg", "LeftFoot", "RightLeg", "RightToeBase"}) {
    EXPECT_LT(largest_jerk(result->clip, "rig:" + joint),
              1.6 * largest_jerk(walk.clip, joint) + 0.002)
        << joint;
  }
}

TEST(Feet, AMeshThatReachesBelowTheJointsOfTheFeetStandsOnTheFloor) {
  const samples::Walk walk = walk_of({});
  Skeleton target = actor_of(1.75, 1, 1, 1, 1);
  const double lowest = target.reference[at(target.find("rig:LeftToeBase_end"))].position.y();
  retarget::Options options;
  options.target_floor = lowest - 0.05;  // thick soles
  const auto result = transfer(walk.clip, target, options);
  ASSERT_TRUE(result.ok());
  EXPECT_NEAR(result->report.floor, 0, 1e-9);
  EXPECT_GT(lowest_of(result->clip), 0.035);
  EXPECT_LT(lowest_of(result->clip), 0.06);
}

}  // namespace
}  // namespace krok
