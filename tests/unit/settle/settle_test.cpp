// If these fail, falls and crawls hover over the ground or sink into it, people lean with a slope,
// knees bend backwards, feet wander, a second pass changes what the first has made, or it depends
// on how a motion is rooted or turned.

#include "settle/settle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/index.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "motion/travel.h"
#include "ragdoll/get_up.h"
#include "samples/generator/rise.h"
#include "terrain/spec.h"

namespace krok {
namespace {

class Settle : public testing::TestWithParam<const char*> {
 protected:
  static Clip rise(samples::Lying from) {
    samples::RiseOptions options;
    options.from = from;
    options.rate = 30;
    return *samples::make_rise(options);
  }

  static std::unique_ptr<Terrain> ground(const char* spec) { return *terrain::from_spec(spec); }

  // Someone who lies and breathes.
  static Clip breathing() {
    const Clip moving = rise(samples::Lying::front);
    constexpr int kFrames = 60;
    Clip clip = moving;
    clip.resize(kFrames);
    std::vector<Transform> pose(clip.skeleton.names.size());
    for (int f = 0; f < kFrames; ++f) {
      moving.get_pose(0, pose);
      const double sway = 0.02 * std::sin(2 * kPi * f / 45);
      for (Transform& joint : pose) joint.position += Vec3(0.5 * sway, 0, sway);
      clip.set_pose(f, pose);
    }
    return clip;
  }

  // Someone who rolls sideways, and three times up to 10 cm into level ground.
  static Clip rolling(double turns) {
    Clip clip = rise(samples::Lying::back);
    std::vector<Transform> pose(clip.skeleton.names.size());
    clip.get_pose(0, pose);
    const std::vector<Transform> lying = pose;
    const auto bodies = *ragdoll::make_bodies(clip.skeleton, find_roles(clip.skeleton));
    const auto level = [](double, double) { return std::optional(0.0); };
    const auto farthest = std::ranges::max(lying, {}, [&](const Transform& joint) {
      return (joint.position - lying[0].position).norm();
    });
    const Vec3 along = farthest.position - lying[0].position;
    const Vec3 axis = Vec3(along.x(), 0, along.z()).normalized();
    clip.resize(60);
    for (int f = 0; f < clip.frame_count(); ++f) {
      const double share = static_cast<double>(f) / clip.frame_count();
      const Quat turn(Eigen::AngleAxisd(2 * kPi * turns * share, axis));
      for (std::size_t j = 0; j < pose.size(); ++j) {
        pose[j].position = turn * lying[j].position;
        pose[j].orientation = turn * lying[j].orientation;
      }
      double depth = -1;
      for (const ragdoll::Body& body : bodies) {
        depth = std::max(depth, ragdoll::depth_in_ground(body, pose, level));
      }
      for (Transform& joint : pose) {
        joint.position.y() += depth - 0.05 * (1 - std::cos(2 * kPi * 3 * share));
      }
      clip.set_pose(f, pose);
    }
    return clip;
  }

  static Settled settled(const Clip& clip, const Terrain& ground) {
    auto result = settle(clip, find_roles(clip.skeleton), ground);
    EXPECT_TRUE(result.ok());
    return *std::move(result);
  }

  // Heights of bodies by the ragdoll's own measure, [bodies][frames], metres.
  static std::vector<std::vector<double>> heights(const Clip& clip, const Terrain& ground) {
    const auto bodies = *ragdoll::make_bodies(clip.skeleton, find_roles(clip.skeleton));
    const auto height = [&](double x, double z) -> std::optional<double> {
      const auto point = ground.at(x, z);
      return point ? std::optional(point->height) : std::nullopt;
    };
    std::vector<std::vector<double>> all(bodies.size());
    std::vector<Transform> pose(clip.skeleton.names.size());
    for (int f = 0; f < clip.frame_count(); ++f) {
      clip.get_pose(f, pose);
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        all[b].push_back(-ragdoll::depth_in_ground(bodies[b], pose, height));
      }
    }
    return all;
  }

  static double largest_distance(const Clip& a, const Clip& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.positions.size(); ++i) {
      largest = std::max<double>(largest, (a.positions[i] - b.positions[i]).norm());
    }
    return largest;
  }
};

TEST_P(Settle, LiesAndCrawlsWithoutHoverOrDepth) {
  const auto on = ground(GetParam());
  for (const samples::Lying from :
       {samples::Lying::front, samples::Lying::back, samples::Lying::side}) {
    const Clip clip = rise(from);
    const Settled result = settled(clip, *on);
    EXPECT_LE(result.after.depth, 0.005);
    EXPECT_LE(result.after.hover, 0.005);
    EXPECT_TRUE(result.warnings.empty());
    EXPECT_LE(std::max(result.after.depth, result.after.hover),
              std::max(result.before.depth, result.before.hover));
    EXPECT_GE(result.touches.size(), 4U);
    // Corners of boxes, which are round here, would be deep in a step that they hardly touch.
    if (std::string_view(GetParam()).starts_with("stairs")) continue;
    const auto measured = heights(result.clip, *on);
    for (const auto& body : measured) {
      for (const double height : body) EXPECT_GT(height, -0.008);
    }
    EXPECT_LT(result.jerk, 6);  // of the smoothest motion there is
  }
}

INSTANTIATE_TEST_SUITE_P(Grounds, Settle,
                         testing::Values("level:height=60cm", "slope:12deg,begin=-5m",
                                         "slope:-8deg,begin=-5m", "rough:seed=7,height=12cm",
                                         "stairs:rise=17cm,run=29cm,count=40,begin=-5m",
                                         "stairs:rise=-17cm,run=29cm,count=40,begin=-5m"));

// Would fail if the feet of an upright body were tilted along the ramp over the edges, or hovered.
TEST_F(Settle, FeetRestOnTreads) {
  const auto on = ground("stairs:rise=17cm,run=29cm,count=40,begin=-5m");
  const Clip clip = rise(samples::Lying::back);
  const Settled result = settled(clip, *on);
  const auto bodies = *ragdoll::make_bodies(clip.skeleton, find_roles(clip.skeleton));
  const auto measured = heights(result.clip, *on);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].name.ends_with("_foot")) continue;
    const int joint = bodies[b].joint;
    for (int f = clip.frame_count() - 5; f < clip.frame_count(); ++f) {
      EXPECT_NEAR(measured[b][at(f)], 0, 0.006) << bodies[b].name << ' ' << f;
      const Quat before = clip.frame_orientations(f)[at(joint)].cast<double>();
      const Quat after = result.clip.frame_orientations(f)[at(joint)].cast<double>();
      const double tilt =
          (before.conjugate() * Vec3::UnitY()).dot(after.conjugate() * Vec3::UnitY());
      EXPECT_GT(tilt, std::cos(4 * kRadiansPerDegree)) << bodies[b].name << ' ' << f;
    }
  }
}

// Would fail if parts shook as they come over one edge or another.
TEST_F(Settle, WhoHardlyMovesIsNotShaken) {
  const Settled result =
      settled(breathing(), *ground("stairs:rise=17cm,run=29cm,count=40,begin=-5m"));
  EXPECT_LE(std::max(result.after.depth, result.after.hover), 0.005);
  EXPECT_LE(result.jerk, 1.5);
}

// Would fail if what rests on a tread counted as deep in the ramp over it, or if a part that nears
// the ground and so touches it from a few millimetres on outweighed how long all of them do.
TEST_F(Settle, TwiceIsOnce) {
  for (const char* spec : {"slope:10deg,begin=-5m", "rough:seed=2,height=10cm",
                           "stairs:rise=17cm,run=29cm,count=40,begin=-5m"}) {
    const auto on = ground(spec);
    for (const Clip& clip : {rise(samples::Lying::back), breathing()}) {
      const Settled once = settled(clip, *on);
      EXPECT_LT(largest_distance(once.clip, settled(once.clip, *on).clip), 5e-5)
          << spec << ' ' << clip.frame_count();
    }
  }
}

// Would fail if a roll, which after settling is over the ground more often than on it, were lowered
// onto it again.
TEST_F(Settle, TwiceIsOnceForRolls) {
  const auto on = ground("level");
  for (const double turns : {0.5, 1.0, 2.0}) {
    const Settled once = settled(rolling(turns), *on);
    EXPECT_GT(once.before.depth, 0.09);
    EXPECT_LT(once.after.depth, 0.005);
    EXPECT_LT(largest_distance(once.clip, settled(once.clip, *on).clip), 5e-5) << turns;
  }
}

// Captures often stand a few centimetres in the floor that their fall ends on. Would fail if they
// crouched instead of being lifted.
TEST_F(Settle, WhoStandsInTheGroundIsLifted) {
  Clip clip = rise(samples::Lying::back);
  constexpr double kDeep = 0.04;
  const int frames = clip.frame_count();
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < frames; ++f) {
    clip.get_pose(f, pose);
    const double part = smoother_step(3.0 * f / frames - 1);  // in the middle third
    for (Transform& joint : pose) joint.position.y() -= kDeep * part;
    clip.set_pose(f, pose);
  }
  const Settled result = settled(clip, *ground("level"));
  EXPECT_GT(result.before.depth, 0.9 * kDeep);
  EXPECT_LT(result.after.depth, 0.005);
  clip.get_pose(frames - 1, pose);
  std::vector<Transform> lifted = pose;
  result.clip.get_pose(frames - 1, lifted);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    EXPECT_NEAR(lifted[j].position.y() - pose[j].position.y(), kDeep, 0.01) << j;
    EXPECT_LT(lifted[j].orientation.angularDistance(pose[j].orientation), 5 * kRadiansPerDegree);
  }
}

TEST_F(Settle, StandsUprightOnASlope) {
  const auto on = ground("slope:12deg,begin=-5m");
  const Clip clip = rise(samples::Lying::front);
  const Settled result = settled(clip, *on);
  const int last = clip.frame_count() - 1, hips = 0, neck = clip.skeleton.find("Neck");
  const auto trunk = [&](const Clip& of, int frame) {
    const auto places = of.frame_positions(frame);
    return Vec3((places[at(neck)] - places[at(hips)]).cast<double>().normalized());
  };
  EXPECT_LT(std::acos(trunk(clip, last).dot(trunk(result.clip, last))), 4 * kRadiansPerDegree);
  // Lying it follows the slope: from lying on the front the trunk is turned by most of it.
  EXPECT_GT(std::acos(trunk(clip, 0).dot(trunk(result.clip, 0))), 6 * kRadiansPerDegree);
}

TEST_F(Settle, BonesKeepTheirLengthsAndKneesTheirSide) {
  const auto on = ground("stairs:rise=12cm,run=32cm,begin=-2m");
  const Clip clip = rise(samples::Lying::back);
  const Settled result = settled(clip, *on);
  const LocalMotion before = local_motion(clip), after = local_motion(result.clip);
  for (int j = 1; j < clip.joint_count(); ++j) {
    for (int f = 0; f < clip.frame_count(); ++f) {
      EXPECT_LT((before.at(j, f).position - after.at(j, f).position).norm(), 1e-5);
    }
  }
  for (const char* knee : {"LeftLeg", "RightLeg"}) {
    const int joint = clip.skeleton.find(knee);
    const auto bend = [&](const Clip& of, int f) {
      const auto places = of.frame_positions(f);
      const auto turns = of.frame_orientations(f);
      const int thigh = of.skeleton.parents[at(joint)];
      const Vec3 upper = (places[at(joint)] - places[at(thigh)]).cast<double>();
      const int foot =
          of.skeleton.find(std::string(knee).substr(0, std::string(knee).size() - 3) + "Foot");
      const Vec3 lower = (places[at(foot)] - places[at(joint)]).cast<double>();
      const Vec3 left = turns[at(thigh)].cast<double>() * Vec3::UnitX();
      return std::atan2(left.dot(upper.cross(lower)), upper.dot(lower));
    };
    for (int f = 0; f < clip.frame_count(); ++f) {
      EXPECT_GT(bend(result.clip, f), std::min(0.0, bend(clip, f)) - 0.03) << knee << ' ' << f;
    }
  }
}

TEST_F(Settle, DoesNotDependOnTheRootOrTheHeading) {
  const auto on = ground("level:height=30cm");
  const Clip clip = rise(samples::Lying::side);
  const Settled result = settled(clip, *on);
  Clip turned = clip;
  const Transform turn{Vec3(2, 0, -1), axis_rotation(Axis::y, 1.1)};
  move_clip(turn, turned);
  Settled result_turned = settled(turned, *on);
  move_clip(turn.inverse(), result_turned.clip);
  EXPECT_LT(largest_distance(result.clip, result_turned.clip), 3e-3);

  // The same below a root that stands elsewhere.
  Clip below;
  below.rate = clip.rate;
  below.skeleton.add("Reference", -1, {});
  for (int j = 0; j < clip.joint_count(); ++j) {
    below.skeleton.add(clip.skeleton.names[at(j)], clip.skeleton.parents[at(j)] + 1,
                       clip.skeleton.reference[at(j)], clip.skeleton.end_sites[at(j)] != 0);
  }
  below.resize(clip.frame_count());
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    std::vector<Transform> with_root = {{Vec3(1, 0, 3), Quat::Identity()}};
    with_root.insert(with_root.end(), pose.begin(), pose.end());
    below.set_pose(f, with_root);
  }
  const Settled result_below = settled(below, *on);
  double largest = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      largest = std::max<double>(largest, (result_below.clip.frame_positions(f)[at(j + 1)] -
                                           result.clip.frame_positions(f)[at(j)])
                                              .norm());
    }
    EXPECT_EQ(result_below.clip.frame_positions(f)[0], Vec3f(1, 0, 3));
  }
  EXPECT_LT(largest, 1e-3);
}

TEST_F(Settle, NoGroundIsAnError) {
  const auto on = ground("stairs:rise=17cm,run=30cm,count=2,begin=0m");
  class Hole : public Terrain {
    std::optional<GroundPoint> at(double, double, double) const override { return std::nullopt; }
  };
  const Clip clip = rise(samples::Lying::front);
  const auto result = settle(clip, find_roles(clip.skeleton), Hole());
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, "settle-ground");
}

}  // namespace
}  // namespace krok
