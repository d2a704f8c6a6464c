// A walk of which everything is known, spoilt by noise and spikes. If these fail, filters do not
// bring it back nearer to the truth, shift it in time, stretch bones, or take honest motion for
// faults.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "filter/smooth_clip.h"
#include "filter/spikes.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "samples/generator/noise.h"
#include "samples/generator/walk.h"
#include "support/test_scenes.h"

namespace krok::filter {
namespace {

samples::WalkOptions walk_options(double noise_degrees = 0) {
  samples::WalkOptions options;
  options.steps = 6;
  options.noise_angle = noise_degrees * kRadiansPerDegree;
  options.noise_position = noise_degrees * 0.003;
  options.seed = 4;
  return options;
}

Clip walk(double noise_degrees = 0) {
  return samples::make_walk(walk_options(noise_degrees)).value().clip;
}

struct Placed {
  int joint, frame, length;
  double size;  // radians, or metres where it is the root's place
  bool of_position;
};

// Spikes on joints that move, some at the ends of the clip.
std::vector<Placed> planted(const Clip& clip) {
  const auto joint = [&](const char* name) {
    const int found = clip.skeleton.find(name);
    EXPECT_GE(found, 0) << name;
    return found;
  };
  const int last = clip.frame_count() - 1;
  return {{joint("LeftForeArm"), 30, 1, 0.7, false},
          {joint("LeftForeArm"), 80, 2, 0.6, false},
          {joint("RightUpLeg"), 60, 1, 0.9, false},
          {joint("RightUpLeg"), 62, 1, -0.8, false},
          {joint("Head"), 0, 1, 0.8, false},
          {joint("LeftLeg"), 101, 3, 1.2, false},
          {joint("RightFoot"), last, 1, 0.9, false},
          {0, 45, 1, 0.25, true},
          {0, 150, 2, 0.3, true}};
}

Clip with_spikes(const Clip& clip, const std::vector<Placed>& spikes) {
  LocalMotion motion = local_motion(clip);
  for (const Placed& spike : spikes) {
    for (int f = spike.frame; f < spike.frame + spike.length; ++f) {
      Transform local = motion.at(spike.joint, f);
      if (spike.of_position) {
        local.position += spike.size * Vec3(0.6, 0, 0.8);
      } else {
        local.orientation =
            local.orientation * from_rotation_vector(spike.size * Vec3(0.48, 0.6, 0.64));
      }
      motion.set(spike.joint, f, local);
    }
  }
  Clip result = clip;
  set_local_motion(motion, result);
  return result;
}

// Root mean square of the joints' rotations to their parents.
double rotation_error(const Clip& a, const Clip& b) {
  const LocalMotion x = local_motion(a), y = local_motion(b);
  double sum = 0;
  for (std::size_t i = 0; i < x.orientations.size(); ++i) {
    sum += std::pow(angle_between(x.orientations[i], y.orientations[i]), 2);
  }
  return std::sqrt(sum / static_cast<double>(x.orientations.size()));
}

double place_error(const Clip& a, const Clip& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    sum += (a.positions[i] - b.positions[i]).cast<double>().squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(a.positions.size()));
}

void expect_bone_lengths(const Clip& a, const Clip& b) {
  const LocalMotion x = local_motion(a), y = local_motion(b);
  for (int j = 1; j < x.joints; ++j) {
    for (int f = 0; f < x.frames; ++f) {
      ASSERT_NEAR((x.at(j, f).position - y.at(j, f).position).norm(), 0, 1e-6) << j << " " << f;
    }
  }
}

void expect_found(const std::vector<Spike>& found, const std::vector<Placed>& planted_spikes) {
  for (const Placed& spike : planted_spikes) {
    for (int f = spike.frame; f < spike.frame + spike.length; ++f) {
      EXPECT_TRUE(std::ranges::any_of(found,
                                      [&](const Spike& s) {
                                        return s.joint == spike.joint &&
                                               s.of_position == spike.of_position &&
                                               s.first_frame <= f && f <= s.last_frame;
                                      }))
          << "joint " << spike.joint << ", frame " << f;
    }
  }
}

TEST(CleanWalk, SpikesAreFoundAndNothingElse) {
  const Clip truth = walk();
  const auto spikes = planted(truth);
  const auto removal = remove_spikes(with_spikes(truth, spikes), {}, {});
  ASSERT_TRUE(removal.ok());
  expect_found(removal->spikes, spikes);
  int frames = 0;
  for (const Spike& spike : removal->spikes) frames += spike.last_frame - spike.first_frame + 1;
  // Two spikes with one good frame between them are one.
  EXPECT_LE(frames, 13 + 1);
  EXPECT_LT(place_error(removal->clip, truth), 1e-3);
  EXPECT_LT(rotation_error(removal->clip, truth), 0.1 * kRadiansPerDegree);
}

TEST(CleanWalk, SpikesAreFoundUnderNoise) {
  const Clip truth = walk();
  const Clip noisy = walk(1);
  const auto spikes = planted(truth);
  const auto removal = remove_spikes(with_spikes(noisy, spikes), {}, {});
  ASSERT_TRUE(removal.ok());
  expect_found(removal->spikes, spikes);
  EXPECT_LE(removal->spikes.size(), spikes.size() + 2);
  EXPECT_LT(rotation_error(removal->clip, truth), 1.05 * rotation_error(noisy, truth));
}

TEST(CleanWalk, WithoutSpikesNothingChanges) {
  for (const double noise : {0.0, 0.2, 1.0}) {
    const Clip clip = walk(noise);
    const auto removal = remove_spikes(clip, {}, {});
    ASSERT_TRUE(removal.ok());
    EXPECT_TRUE(removal->spikes.empty()) << noise << ": " << removal->spikes.size();
    EXPECT_EQ(removal->clip.positions, clip.positions);
  }
}

// Fits to markers turn the hips one way and the legs back, each by less than a spike. Else the foot
// that stands is thrown aside by the length of the leg.
TEST(CleanWalk, FeetAreNotThrownWhereTheHipsJumpAlone) {
  const Clip truth = walk();
  LocalMotion motion = local_motion(truth);
  const Quat jump = from_rotation_vector(Vec3(0.06, 0.05, 0.06));
  const auto turn = [&](const char* name, const Quat& by) {
    const int joint = truth.skeleton.find(name);
    ASSERT_GE(joint, 0) << name;
    Transform local = motion.at(joint, 70);
    local.orientation = local.orientation * by;
    motion.set(joint, 70, local);
  };
  turn("Hips", jump);
  const Quat back = slerp(Quat::Identity(), jump.conjugate(), 0.5);
  for (const char* name : {"LeftUpLeg", "LeftLeg", "RightUpLeg", "RightLeg"}) turn(name, back);
  Clip spoilt = truth;
  set_local_motion(motion, spoilt);
  const auto removal = remove_spikes(spoilt, {}, {});
  ASSERT_TRUE(removal.ok());
  EXPECT_FALSE(removal->spikes.empty());
  for (const char* name : {"LeftFoot", "RightFoot"}) {
    const auto foot = static_cast<std::size_t>(truth.skeleton.find(name));
    EXPECT_LT((removal->clip.frame_positions(70)[foot] - truth.frame_positions(70)[foot]).norm(),
              0.005f)
        << name;
  }
  // What may not be replaced to go with it keeps the spike.
  std::vector<std::uint8_t> hips(truth.skeleton.names.size(), 0);
  hips[0] = 1;
  const auto alone = remove_spikes(spoilt, {}, hips);
  ASSERT_TRUE(alone.ok());
  EXPECT_TRUE(alone->spikes.empty());
}

TEST(CleanWalk, AJumpThatStaysIsNoSpike) {
  Clip clip = walk();
  LocalMotion motion = local_motion(clip);
  const int arm = clip.skeleton.find("LeftArm");
  for (int f = 100; f < motion.frames; ++f) {
    Transform local = motion.at(arm, f);
    local.orientation = local.orientation * from_rotation_vector(Vec3(0.8, 0, 0));
    motion.set(arm, f, local);
  }
  set_local_motion(motion, clip);
  const auto removal = remove_spikes(clip, {}, {});
  ASSERT_TRUE(removal.ok());
  EXPECT_TRUE(removal->spikes.empty());
}

TEST(CleanWalk, ComesBackNearerToTheTruth) {
  const Clip truth = walk();
  const Clip noisy = walk(1);
  for (const Smoothing& smoothing :
       {Smoothing(Butterworth{8, 4}), Smoothing(SavitzkyGolay{9, 3})}) {
    const auto result = smooth(noisy, smoothing, {}, 2);
    ASSERT_TRUE(result.ok());
    EXPECT_LT(rotation_error(*result, truth), 0.6 * rotation_error(noisy, truth));
    EXPECT_LT(place_error(*result, truth), 0.7 * place_error(noisy, truth));
    expect_bone_lengths(*result, noisy);
    EXPECT_EQ(result->rate, noisy.rate);
    EXPECT_TRUE(krok::check(*result).ok());
  }
}

TEST(CleanWalk, SpikesAndNoiseTogether) {
  const Clip truth = walk();
  const Clip spoilt = with_spikes(walk(1), planted(truth));
  const auto removal = remove_spikes(spoilt, {}, {});
  ASSERT_TRUE(removal.ok());
  const auto result = smooth(removal->clip, Butterworth{8, 4}, {});
  ASSERT_TRUE(result.ok());
  EXPECT_LT(rotation_error(*result, truth), 0.4 * rotation_error(spoilt, truth));
  EXPECT_LT(place_error(*result, truth), 0.5 * place_error(spoilt, truth));
}

TEST(CleanWalk, NothingIsShiftedInTime) {
  const Clip truth = walk();
  const auto result = smooth(walk(1), Butterworth{8, 4}, {});
  ASSERT_TRUE(result.ok());
  // Cross-correlation of the swinging thigh's angle with the truth's peaks where they coincide.
  const int thigh = truth.skeleton.find("LeftUpLeg");
  const auto pitch = [&](const Clip& clip) {
    const LocalMotion motion = local_motion(clip);
    std::vector<double> angles;
    for (int f = 0; f < motion.frames; ++f) {
      angles.push_back(rotation_vector(motion.at(thigh, f).orientation).x());
    }
    return angles;
  };
  const auto a = pitch(*result), b = pitch(truth);
  const auto correlation = [&](int lag) {
    double sum = 0;
    for (int f = 5; f + 5 < static_cast<int>(a.size()); ++f) {
      sum -= std::pow(a[static_cast<std::size_t>(f)] - b[static_cast<std::size_t>(f + lag)], 2);
    }
    return sum;
  };
  for (const int lag : {-3, -2, -1, 1, 2, 3}) EXPECT_GT(correlation(0), correlation(lag)) << lag;
  // The parabola through three lags has its top within a tenth of a frame of none.
  const double left = correlation(-1), middle = correlation(0), right = correlation(1);
  EXPECT_NEAR(0.5 * (left - right) / (left - 2 * middle + right), 0, 0.1);
}

TEST(SmoothClip, OnlyTheJointsAskedFor) {
  const Clip noisy = walk(1);
  std::vector<std::uint8_t> joints(noisy.skeleton.names.size(), 0);
  const int arm = noisy.skeleton.find("LeftArm");
  joints[static_cast<std::size_t>(arm)] = 1;
  const auto result = smooth(noisy, Butterworth{}, joints);
  ASSERT_TRUE(result.ok());
  const LocalMotion before = local_motion(noisy), after = local_motion(*result);
  for (int j = 0; j < before.joints; ++j) {
    double most = 0;
    for (int f = 0; f < before.frames; ++f) {
      most = std::max(most, angle_between(before.at(j, f).orientation, after.at(j, f).orientation));
    }
    if (j == arm) {
      EXPECT_GT(most, 1e-3);
    } else {
      EXPECT_LT(most, 1e-6) << j;
    }
  }
  const auto removal = remove_spikes(with_spikes(walk(), planted(walk())), {}, joints);
  EXPECT_TRUE(removal->spikes.empty());
}

TEST(SmoothClip, TheSameBytesForAnyNumberOfThreads) {
  const Clip noisy = walk(1);
  const auto one = smooth(noisy, Butterworth{}, {}, 1), four = smooth(noisy, Butterworth{}, {}, 4);
  EXPECT_EQ(one->positions, four->positions);
  for (std::size_t i = 0; i < one->orientations.size(); ++i) {
    ASSERT_EQ(one->orientations[i].coeffs(), four->orientations[i].coeffs());
  }
}

// If a block's overlap were too short, its ends would show as steps.
TEST(SmoothClip, InBlocksAsInOne) {
  samples::WalkOptions options = walk_options(1);
  options.steps = 30;
  const Clip clip = samples::make_walk(options).value().clip;
  const int frames = clip.frame_count();
  for (const Smoothing& smoothing : {Smoothing(Butterworth{6, 4}), Smoothing(Butterworth{9, 8}),
                                     Smoothing(SavitzkyGolay{11, 3})}) {
    const Clip whole = smooth(clip, smoothing, {}).value();
    const auto in_blocks = [&](int block, int jobs, int& watched) {
      const auto watch = [&](const FrameRun& before, const Clip& after) {
        EXPECT_EQ(before.clip.frame_count(), after.frame_count());
        watched += before.kept_end - before.kept_begin;
      };
      return load(*smooth(frames_of(clip), smoothing, {}, jobs, watch, block), jobs).value();
    };
    int watched = 0;
    const Clip one = in_blocks(frames, 2, watched);
    EXPECT_EQ(watched, frames);
    EXPECT_TRUE(one.positions == whole.positions);
    EXPECT_TRUE(one.orientations == whole.orientations);
    for (const int block : {frames - 1, 150, 64}) {
      watched = 0;
      const Clip many = in_blocks(block, 1, watched);
      EXPECT_EQ(watched, frames);
      constexpr int kNearEnds = 40;
      double inside = 0, at_ends = 0;  // radians or metres
      for (int f = 0; f < frames; ++f) {
        double& largest = f < kNearEnds || f >= frames - kNearEnds ? at_ends : inside;
        for (std::size_t j = 0; j < clip.skeleton.names.size(); ++j) {
          const double distance =
              (many.frame_positions(f)[j] - whole.frame_positions(f)[j]).cast<double>().norm();
          const double angle = angle_between(many.frame_orientations(f)[j].cast<double>(),
                                             whole.frame_orientations(f)[j].cast<double>());
          largest = std::max({largest, distance, angle});
        }
      }
      EXPECT_LT(inside, 1e-6) << block;
      EXPECT_LT(at_ends, 3e-5) << block;
    }
  }
}

// If a block's overlap were too short, spikes near its ends would be missed, found twice, or be
// replaced by another value on either side.
TEST(CleanWalk, SpikesInBlocksAsInOne) {
  samples::WalkOptions options = walk_options(0.3);
  options.steps = 30;
  const Clip truth = samples::make_walk(options).value().clip;
  const Clip clip = with_spikes(truth, planted(truth));
  const auto whole = remove_spikes(clip, {}, {});
  expect_found(whole->spikes, planted(truth));
  for (const int block : {clip.frame_count(), 151, 63}) {
    std::vector<Spike> spikes;
    const auto watch = [&](const FrameRun&, const SpikeRemoval& after) {
      spikes.insert(spikes.end(), after.spikes.begin(), after.spikes.end());
    };
    const Clip made = load(*remove_spikes(frames_of(clip), {}, {}, 2, watch, block), 1).value();
    std::ranges::stable_sort(
        spikes, {}, [](const Spike& spike) { return std::tuple(spike.joint, spike.of_position); });
    ASSERT_EQ(spikes.size(), whole->spikes.size()) << block;
    for (std::size_t i = 0; i < spikes.size(); ++i) {
      EXPECT_EQ(spikes[i].joint, whole->spikes[i].joint);
      EXPECT_EQ(spikes[i].first_frame, whole->spikes[i].first_frame);
      EXPECT_EQ(spikes[i].last_frame, whole->spikes[i].last_frame);
      EXPECT_EQ(spikes[i].size, whole->spikes[i].size);
    }
    double largest = 0;
    for (std::size_t i = 0; i < made.orientations.size(); ++i) {
      largest = std::max({largest,
                          angle_between(made.orientations[i].cast<double>(),
                                        whole->clip.orientations[i].cast<double>()),
                          (made.positions[i] - whole->clip.positions[i]).cast<double>().norm()});
    }
    EXPECT_LT(largest, block == clip.frame_count() ? 1e-12 : 1e-6) << block;
  }
}

TEST(SmoothClip, NoFramesFewFramesOneJoint) {
  Skeleton single;
  single.add("root", -1, {});
  for (const Skeleton& skeleton : {test::human_skeleton(), single}) {
    for (const int frames : {0, 1, 2, 3, 4, 5}) {
      const Clip clip = test::swinging_clip(skeleton, frames, 60);
      for (const Smoothing& smoothing : {Smoothing(Butterworth{}), Smoothing(SavitzkyGolay{})}) {
        const auto result = smooth(clip, smoothing, {});
        ASSERT_TRUE(result.ok());
        EXPECT_EQ(result->frame_count(), frames);
        EXPECT_TRUE(krok::check(*result).ok());
        if (frames < 3) {
          EXPECT_EQ(result->positions, clip.positions);
        }
      }
      const auto removal = remove_spikes(clip, {}, {});
      ASSERT_TRUE(removal.ok());
      EXPECT_EQ(removal->clip.frame_count(), frames);
      EXPECT_TRUE(removal->spikes.empty());
    }
  }
}

TEST(SmoothClip, RefusesOptionsThatMakeNoSense) {
  const Clip clip = walk();
  EXPECT_EQ(smooth(clip, Butterworth{30, 4}, {}).error().code, "filter-cutoff");
  EXPECT_EQ(smooth(clip, Butterworth{6, 3}, {}).error().code, "filter-order");
  EXPECT_EQ(smooth(clip, SavitzkyGolay{8, 3}, {}).error().code, "filter-window");
  EXPECT_EQ(smooth(clip, SavitzkyGolay{9, 9}, {}).error().code, "filter-degree");
  SpikeOptions options;
  options.threshold = 0;
  EXPECT_EQ(remove_spikes(clip, options, {}).error().code, "filter-threshold");
}

}  // namespace
}  // namespace krok::filter
