// Properties of all skeletons and motions, tested on random ones: any tree, any joint axes,
// tumbling motion. If these fail, an edit works only for typical skeletons.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "filter/smooth_clip.h"
#include "filter/spikes.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/join.h"
#include "motion/local_motion.h"
#include "motion/loop.h"
#include "motion/mirror.h"
#include "motion/sample.h"
#include "motion/travel.h"

namespace krok {
namespace {

using Random = std::mt19937;

double uniform(Random& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}
Vec3 vector(Random& random, double size) {
  return {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)};
}

Clip random_clip(Random& random, int frames) {
  Clip clip;
  clip.rate = uniform(random, 10, 120);
  const int joints = 1 + static_cast<int>(random() % 25);
  for (int j = 0; j < joints; ++j) {
    const int parent = j == 0 ? -1 : static_cast<int>(random() % static_cast<unsigned>(j));
    const Vec3 from = parent < 0
                          ? Vec3::Zero()
                          : clip.skeleton.reference[static_cast<std::size_t>(parent)].position;
    clip.skeleton.add("joint" + std::to_string(j), parent,
                      {from + vector(random, 0.4), from_rotation_vector(vector(random, 3))});
  }
  LocalMotion motion;
  motion.joints = joints;
  motion.frames = frames;
  const std::size_t count = static_cast<std::size_t>(joints) * static_cast<std::size_t>(frames);
  motion.orientations.resize(count);
  motion.positions.resize(count);
  for (int j = 0; j < joints; ++j) {
    const Transform rest = clip.skeleton.reference_local(j);
    const Vec3 a = vector(random, 1), b = vector(random, 0.5), way = vector(random, 0.02);
    const double pace = uniform(random, 0.05, 0.3);
    for (int f = 0; f < frames; ++f) {
      const Quat turn = from_rotation_vector(std::sin(pace * f) * a) *
                        from_rotation_vector(std::cos(1.7 * pace * f) * b);
      motion.set(j, f,
                 {j == 0 ? Vec3(rest.position + f * way) : rest.position, rest.orientation * turn});
    }
  }
  set_local_motion(motion, clip);
  return clip;
}

double distance(const Clip& a, const Clip& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    most = std::max<double>(most, (a.positions[i] - b.positions[i]).norm());
    most = std::max(
        most, angle_between(a.orientations[i].cast<double>(), b.orientations[i].cast<double>()));
  }
  return most;
}

constexpr int kRounds = 60;

TEST(Edits, MirroredTwiceIsTheSame) {
  Random random(1);
  for (int round = 0; round < kRounds; ++round) {
    const Clip clip = random_clip(random, 5);
    const MirrorPairs pairs = find_mirror_pairs(clip.skeleton, find_roles(clip.skeleton));
    for (std::size_t j = 0; j < pairs.partners.size(); ++j) {
      if (pairs.partners[j] == MirrorPairs::kNone) continue;
      EXPECT_EQ(pairs.partners[static_cast<std::size_t>(pairs.partners[j])], static_cast<int>(j));
    }
    const Clip once = mirror(clip, pairs);
    EXPECT_TRUE(check(once).ok());
    EXPECT_LT(distance(mirror(once, pairs), clip), 2e-5) << round;
  }
}

TEST(Edits, ALoopEndsAsItBeginsWhateverTheMotion) {
  Random random(2);
  for (int round = 0; round < kRounds; ++round) {
    const Clip clip = random_clip(random, 4 + static_cast<int>(random() % 60));
    const auto result = loop(clip, 0, {.blend = uniform(random, 0, 1)});
    ASSERT_TRUE(result.ok());
    ASSERT_TRUE(check(result->clip).ok());
    const int last = result->clip.frame_count() - 1;
    Clip first = cut(result->clip, 0, 0);
    move_clip(result->displacement, first);
    EXPECT_LT(distance(first, cut(result->clip, last, last)), 1e-5) << round;
    EXPECT_LE(result->after.angle, 1e-6);
  }
}

TEST(Edits, CutAndJoinedIsTheSame) {
  Random random(3);
  for (int round = 0; round < kRounds; ++round) {
    const Clip clip = random_clip(random, 30);
    const int at = 5 + static_cast<int>(random() % 20);
    Clip second = cut(clip, at, 29);
    move_clip({Vec3(uniform(random, -9, 9), 0, uniform(random, -9, 9)),
               from_rotation_vector(Vec3(0, uniform(random, -3, 3), 0))},
              second);
    const auto joined = join(cut(clip, 0, at), second, 0, {.blend = 0});
    ASSERT_TRUE(joined.ok());
    EXPECT_LT(distance(joined->clip, clip), 3e-5) << round;
  }
}

TEST(Edits, WhereAMotionIsDoesNotMatterToFiltersAndTravel) {
  Random random(4);
  for (int round = 0; round < kRounds; ++round) {
    const Clip clip = random_clip(random, 40);
    const Transform move{Vec3(uniform(random, -3, 3), 0.5, uniform(random, -3, 3)),
                         from_rotation_vector(Vec3(0, uniform(random, -3, 3), 0))};
    Clip moved = clip;
    move_clip(move, moved);
    const auto commutes = [&](auto&& edit) {
      Clip expected = edit(clip);
      move_clip(move, expected);
      return distance(edit(moved), expected);
    };
    const filter::Butterworth low_pass{clip.rate / 8, 4};
    EXPECT_LT(commutes([&](const Clip& c) { return filter::smooth(c, low_pass, {}).value(); }),
              2e-5);
    EXPECT_LT(
        commutes([&](const Clip& c) { return filter::remove_spikes(c, {}, {}).value().clip; }),
        2e-5);
    EXPECT_LT(commutes([&](const Clip& c) { return in_place(c, 0, Travel::all); }), 2e-5);
  }
}

}  // namespace
}  // namespace krok
