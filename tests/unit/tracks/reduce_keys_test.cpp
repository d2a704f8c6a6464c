// Would fail if a motion with fewer keys left its tolerance anywhere on the body, kept keys that it
// does not need, or came out differently for another number of threads.

#include "tracks/reduce_keys.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "math/quaternion.h"
#include "motion/sample.h"
#include "samples/generator/noise.h"
#include "samples/generator/walk.h"
#include "support/reduced_motion.h"
#include "support/test_scenes.h"
#include "support/this_build.h"

namespace krok {
namespace {

using test::reduce_keys;
using test::ReducedClip;

// The furthest that a point of a sphere around a joint is off, tried in 26 directions at `times` a
// frame.
double error_in_model(const Clip& clip, const ReducedClip& reduced, double shell, int times) {
  std::vector<Vec3> directions;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) directions.push_back(shell * Vec3(x, y, z).normalized());
      }
    }
  }
  const std::size_t joints = clip.skeleton.names.size();
  std::vector<Transform> world(joints), scratch(3 * joints), pose(joints);
  double worst = 0;
  for (int i = 0; i <= times * (clip.frame_count() - 1); ++i) {
    const double time = i / (times * clip.rate);
    sample(clip, time, world, scratch);
    reduced.pose_at(time, pose);
    for (std::size_t j = 0; j < joints; ++j) {
      for (const Vec3& point : directions) {
        worst = std::max(worst, (world[j] * point - pose[j] * point).norm());
      }
    }
  }
  return worst;
}

Clip walk() {
  samples::WalkOptions options;
  options.steps = 6;
  return samples::make_walk(options).value().clip;
}

ReducedClip reduced(const Clip& clip, double tolerance, int jobs = 1) {
  auto result = reduce_keys(clip, {.tolerance = tolerance, .shell_distance = 0.03}, jobs);
  EXPECT_TRUE(result.ok());
  return *std::move(result);
}

TEST(ReduceKeys, StaysWithinItsToleranceAllOverTheBody) {
  for (const Clip& clip : {walk(), test::swinging_clip(test::human_skeleton(), 90, 30)}) {
    for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
      const ReducedClip result = reduced(clip, tolerance);
      EXPECT_LE(result.reduction.largest_error, tolerance);
      const double at_frames = error_in_model(clip, result, 0.03, 1);
      EXPECT_LE(at_frames, tolerance);
      EXPECT_GE(at_frames, 0.3 * tolerance) << "nothing was gained";
      EXPECT_LE(error_in_model(clip, result, 0.03, 3), 1.02 * tolerance);
      EXPECT_EQ(result.reduction.keys_after, result.key_count());
    }
  }
}

TEST(ReduceKeys, TakesFewerKeysForMoreTolerance) {
  const Clip clip = walk();
  std::size_t before = reduced(clip, 1e-6).reduction.keys_after;
  for (const double tolerance : {1e-5, 1e-4, 1e-3, 1e-2}) {
    const std::size_t now = reduced(clip, tolerance).reduction.keys_after;
    EXPECT_LT(now, before) << tolerance;
    before = now;
  }
  EXPECT_LT(5 * reduced(clip, 1e-3).reduction.keys_after,
            reduced(clip, 1e-3).reduction.keys_before);
}

TEST(ReduceKeys, TracksOfWhichFewKeysGoKeepAllWhereThatIsAskedFor) {
  const Clip clip = walk();
  const auto frames = static_cast<std::size_t>(clip.frame_count());
  const auto result =
      reduce_keys(clip, {.tolerance = 2e-4, .shell_distance = 0.03, .most_kept = 0.4});
  ASSERT_TRUE(result.ok());
  EXPECT_LE(error_in_model(clip, *result, 0.03, 1), 2e-4);
  std::size_t whole = 0, parts = 0;
  for (const KeptFrames& joint : result->reduction.joints) {
    for (const std::vector<int>& kept : {joint.position, joint.rotation}) {
      if (kept.size() == frames) {
        ++whole;
      } else {
        EXPECT_LE(static_cast<double>(kept.size()), 0.4 * static_cast<double>(frames));
        ++parts;
      }
    }
  }
  EXPECT_GT(whole, 0u);
  EXPECT_GT(parts, 0u);
}

TEST(ReduceKeys, WhatDoesNotMoveKeepsOneKey) {
  Clip clip;
  clip.skeleton = test::human_skeleton();
  clip.resize(100);
  for (int f = 0; f < 100; ++f) clip.set_pose(f, clip.skeleton.reference);
  const ReducedClip result = reduced(clip, 1e-4);
  EXPECT_EQ(result.reduction.keys_after, 2 * clip.skeleton.names.size());
  EXPECT_EQ(result.reduction.largest_error, 0);
}

TEST(ReduceKeys, EvenMotionKeepsItsEnds) {
  // The root goes straight on and turns at an even pace, three quarters of a turn in all.
  Clip clip;
  clip.skeleton.add("root", -1, {});
  clip.resize(91);
  for (int f = 0; f < 91; ++f) {
    const Transform pose{Vec3(0.01 * f, 0, -0.02 * f),
                         from_rotation_vector(Vec3(0, 0.0524 * f, 0))};
    clip.set_pose(f, std::vector{pose});
  }
  const ReducedClip result = reduced(clip, 1e-4);
  EXPECT_EQ(result.reduction.joints[0].position, (std::vector{0, 90}));
  // More than half a turn needs a key between.
  EXPECT_EQ(result.reduction.joints[0].rotation.size(), 3u);
}

// The fewest keys of a single joint's position, by trying all: count[b] is the least number of keys
// from the first frame to b.
std::size_t fewest_position_keys(const std::vector<Vec3>& values, double tolerance) {
  std::vector<std::size_t> count(values.size(), 1);
  for (std::size_t b = 1; b < values.size(); ++b) {
    count[b] = b + 1;
    for (std::size_t a = 0; a < b; ++a) {
      bool fits = true;
      for (std::size_t f = a + 1; fits && f < b; ++f) {
        const double part = static_cast<double>(f - a) / static_cast<double>(b - a);
        fits = (values[a] + part * (values[b] - values[a]) - values[f]).norm() <= tolerance;
      }
      if (fits) count[b] = std::min(count[b], count[a] + 1);
    }
  }
  return count.back();
}

TEST(ReduceKeys, OfOneTrackComesNearTheFewestThereCanBe) {
  std::mt19937 random(5u);
  const auto unit = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  std::size_t ours = 0, fewest = 0;
  for (int curve = 0; curve < 20; ++curve) {
    Clip clip;
    clip.skeleton.add("root", -1, {});
    clip.resize(120);
    const Vec3 slow(unit(), unit(), unit()), fast(unit(), unit(), unit());
    std::vector<Vec3> values;
    for (int f = 0; f < 120; ++f) {
      clip.positions[static_cast<std::size_t>(f)] =
          (std::sin(0.05 * f) * slow + 0.2 * std::sin(0.21 * f + curve) * fast).cast<float>();
      values.push_back(clip.positions[static_cast<std::size_t>(f)].cast<double>());
    }
    ours += reduced(clip, 5e-3).reduction.joints[0].position.size();
    fewest += fewest_position_keys(values, 5e-3);
  }
  EXPECT_GE(ours, fewest);
  EXPECT_LE(static_cast<double>(ours), 1.08 * static_cast<double>(fewest)) << fewest;
}

TEST(ReduceKeys, HoldsForAnyMotion) {
  std::mt19937 random(8u);
  const auto unit = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  for (int round = 0; round < 60; ++round) {
    Clip clip;
    const int joints = 1 + static_cast<int>(random() % 7);
    for (int j = 0; j < joints; ++j) {
      const int parent = j == 0 ? -1 : static_cast<int>(random() % static_cast<unsigned>(j));
      clip.skeleton.add(std::to_string(j), parent, {});
    }
    clip.resize(1 + static_cast<int>(random() % 50));
    // Some joints rest for some frames, some jump, some move evenly.
    std::vector<Transform> pose(clip.skeleton.names.size());
    for (int f = 0; f < clip.frame_count(); ++f) {
      for (Transform& joint : pose) {
        if (random() % 3 == 0) joint.position += 0.1 * Vec3(unit(), unit(), unit());
        if (random() % 3 == 0) {
          joint.orientation = normalized_or_identity(
              joint.orientation * from_rotation_vector(3 * unit() * Vec3(unit(), unit(), unit())));
        }
      }
      clip.set_pose(f, pose);
    }
    const double tolerance = std::pow(10.0, -1 - 2 * (1 + unit()));
    const ReducedClip result = reduced(clip, tolerance);
    EXPECT_LE(error_in_model(clip, result, 0.03, 1), tolerance + 1e-12) << round;
    EXPECT_LE(result.reduction.keys_after, result.reduction.keys_before);
  }
}

TEST(ReduceKeys, SignsOfQuaternionsDoNotTell) {
  Clip clip = walk();
  const Reduction expected = reduced(clip, 1e-3).reduction;
  for (std::size_t i = 0; i < clip.orientations.size(); i += 3) {
    clip.orientations[i].coeffs() = -clip.orientations[i].coeffs();
  }
  EXPECT_EQ(reduced(clip, 1e-3).reduction.keys_after, expected.keys_after);
}

TEST(ReduceKeys, LongMotionsGoInStretchesWhateverTheThreads) {
  Skeleton chain;
  for (int j = 0; j < 5; ++j)
    chain.add(std::to_string(j), j - 1, {Vec3(0, 0.2 * j, 0), {1, 0, 0, 0}});
  for (const int frames : {1025, 1026, 2100}) {
    const Clip clip = test::swinging_clip(chain, frames, 60);
    const ReducedClip one = reduced(clip, 1e-3, 1), many = reduced(clip, 1e-3, 4);
    for (std::size_t j = 0; j < one.reduction.joints.size(); ++j) {
      EXPECT_EQ(one.reduction.joints[j].position, many.reduction.joints[j].position);
      EXPECT_EQ(one.reduction.joints[j].rotation, many.reduction.joints[j].rotation);
    }
    EXPECT_EQ(one.reduction.joints[1].rotation.back(), frames - 1);
    EXPECT_LE(error_in_model(clip, one, 0.03, 1), 1e-3);
  }
}

TEST(ReduceKeys, OfNothingIsNothing) {
  EXPECT_EQ(reduced(Clip(), 1e-3).reduction.keys_after, 0u);
  Clip clip;
  clip.skeleton = test::human_skeleton();
  const ReducedClip none = reduced(clip, 1e-3);
  EXPECT_EQ(none.key_count(), 0u);
  clip.resize(1);
  clip.set_pose(0, clip.skeleton.reference);
  EXPECT_EQ(reduced(clip, 1e-3).key_count(), 2 * clip.skeleton.names.size());
  clip.resize(2);
  clip.set_pose(1, clip.skeleton.reference);
  EXPECT_EQ(reduced(clip, 1e-3).key_count(), 2 * clip.skeleton.names.size());
}

TEST(ReduceKeys, WhatIsNotANumberKeepsItsKeys) {
  Clip clip = test::swinging_clip(test::human_skeleton(), 30, 30);
  clip.positions[10 * clip.skeleton.names.size() + 3].x() = std::nanf("");
  const auto result = reduce_keys(clip, {});
  ASSERT_TRUE(result.ok());
  EXPECT_FALSE(std::isnan(result->reduction.largest_error));
}

TEST(ReduceKeys, RefusesTolerancesThatAreNone) {
  const Clip clip = test::swinging_clip(test::human_skeleton(), 3, 30);
  for (const ReduceOptions& options :
       {ReduceOptions{0, 0.03}, ReduceOptions{-1, 0.03}, ReduceOptions{std::nan(""), 0.03},
        ReduceOptions{1e-3, -1}, ReduceOptions{1e-3, std::nan("")},
        ReduceOptions{.tolerance = 1e-3, .most_kept = -1}}) {
    const auto result = reduce_keys(clip, options);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, "reduce-tolerance");
  }
}

TEST(ReduceKeys, OfRealCapturesLeavesAFewKeysWithinTheTolerance) {
  const std::filesystem::path root = std::filesystem::path(test::corpus_folder()) / "bvh";
  if (!std::filesystem::exists(root)) GTEST_SKIP() << "skipped: no corpus at " << root;
  // At a millimetre: the keys that stay, at most, of a hundred.
  for (const auto& [name, most] : {std::pair{"pybvh/cmu_12_01_walk.bvh", 16.0},
                                   {"walkset_cmu07/007_02.bvh", 10.0},
                                   {"animated_drawings/fair1_zombie.bvh", 27.0}}) {
    auto input = InputFile::open((root / name).string());
    ASSERT_TRUE(input.ok());
    const auto capture = bvh::read(input->text(), name, {});
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    const ReducedClip result = reduced(capture->clip, 1e-3);
    EXPECT_LE(error_in_model(capture->clip, result, 0.03, 1), 1e-3) << name;
    EXPECT_LE(100.0 * static_cast<double>(result.reduction.keys_after),
              most * static_cast<double>(result.reduction.keys_before))
        << name;
  }
}

// Joints below each other, half of the frames turned at `moving` of them.
Reduction reduced_chain(int joints, int moving, std::string& code) {
  std::vector<int> parents(static_cast<std::size_t>(joints));
  for (int j = 0; j < joints; ++j) parents[static_cast<std::size_t>(j)] = j - 1;
  const std::vector<double> times = {0, 0.1, 0.2};
  Transform still;
  still.position = Vec3(0, 0.01, 0);
  std::vector<Transform> local(3 * parents.size(), still);
  for (int j = 0; j < moving; ++j) {
    local[parents.size() + static_cast<std::size_t>(j)].orientation =
        Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  }
  auto result = choose_keys(parents, times, local, {.tolerance = 0.001});
  code = result ? std::string() : result.error().code;
  return result ? *std::move(result) : Reduction();
}

// If this failed, a chain of tens of thousands of joints would take minutes and gigabytes.
TEST(ReduceKeys, LongChainsAreQuickOrRefused) {
  std::string code;
  EXPECT_EQ(reduced_chain(60'000, 0, code).keys_after, 2u * 60'000);
  EXPECT_EQ(code, "");
  EXPECT_EQ(reduced_chain(60'000, 2, code).keys_after, 2u * 60'000 + 2 * 2);
  EXPECT_EQ(code, "");
  (void)reduced_chain(2'000, 2'000, code);
  EXPECT_EQ(code, "reduce-joints");
}

}  // namespace
}  // namespace krok
