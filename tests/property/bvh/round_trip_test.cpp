// If this fails, a skeleton or motion changes when written as BVH and read again.

#include <random>

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

Quat random_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

Vec3 random_step(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  return {uniform(random), uniform(random), uniform(random)};
}

// A tree with joints in depth-first order, rotated reference frames, zero-length bones, and a
// motion in which some joints also translate.
Clip random_clip(unsigned seed) {
  std::mt19937 random(seed);
  const auto chance = [&](int one_in) {
    return std::uniform_int_distribution<int>(1, one_in)(random) == 1;
  };
  const int joints = std::uniform_int_distribution<int>(1, 30)(random);
  const int frames = std::uniform_int_distribution<int>(0, 12)(random);
  Clip clip;
  clip.rate = std::uniform_real_distribution<double>(5.0, 250.0)(random);
  std::vector<int> chain;  // from the root to the last joint
  std::vector<bool> slides;
  for (int j = 0; j < joints; ++j) {
    if (j > 0) chain.resize(std::uniform_int_distribution<std::size_t>(1, chain.size())(random));
    const int parent = chain.empty() ? -1 : chain.back();
    Transform local{chance(6) ? Vec3(Vec3::Zero()) : random_step(random, 0.5),
                    chance(2) ? Quat::Identity() : random_turn(random)};
    if (parent >= 0) local = clip.skeleton.reference[static_cast<std::size_t>(parent)] * local;
    clip.skeleton.add("joint " + std::to_string(j), parent, local);
    chain.push_back(j);
    slides.push_back(chance(8));
  }
  const auto children = clip.skeleton.children();
  for (std::size_t j = 1; j < children.size(); ++j) {
    if (children[j].empty() && chance(2)) {
      clip.skeleton.end_sites[j] = 1;
      clip.skeleton.names[j] = "end";
    }
  }
  clip.resize(frames);
  std::vector<Transform> pose(static_cast<std::size_t>(joints));
  for (int frame = 0; frame < frames; ++frame) {
    for (int j = 0; j < joints; ++j) {
      const auto index = static_cast<std::size_t>(j);
      Transform local = clip.skeleton.reference_local(j);
      if (j == 0 || (slides[index] && clip.skeleton.end_sites[index] == 0)) {
        local.position += random_step(random, 1.0);
      }
      if (clip.skeleton.end_sites[index] == 0) {
        local.orientation = local.orientation * random_turn(random);
      }
      const int parent = clip.skeleton.parents[index];
      pose[index] = parent < 0 ? local : pose[static_cast<std::size_t>(parent)] * local;
    }
    clip.set_pose(frame, pose);
  }
  return clip;
}

// Names end sites as the reader does.
void name_end_sites(Skeleton& skeleton) {
  std::vector<int> count(skeleton.names.size(), 0);
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    if (skeleton.end_sites[j] == 0) continue;
    const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
    const int number = ++count[parent];
    skeleton.names[j] =
        skeleton.names[parent] + "_end" + (number == 1 ? "" : "_" + std::to_string(number));
  }
}

TEST(RoundTrip, RandomSkeletonsAndMotionsSurvive) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Clip clip = random_clip(seed);
    name_end_sites(clip.skeleton);
    ASSERT_TRUE(check(clip).ok());
    WriteOptions options;
    options.root_offset = true;
    ReadOptions reading = plain_options();
    reading.unit = Unit{0.01, "cm"};
    reading.strictness = Strictness::strict;
    const Capture back = read_ok(written(clip, options), reading);
    ASSERT_EQ(difference_in_structure(clip.skeleton, back.clip.skeleton), "");
    ASSERT_EQ(clip.skeleton.end_sites, back.clip.skeleton.end_sites);
    ASSERT_EQ(clip.frame_count(), back.clip.frame_count());
    EXPECT_DOUBLE_EQ(clip.rate, back.clip.rate);
    for (std::size_t j = 0; j < clip.skeleton.names.size(); ++j) {
      EXPECT_LT(
          (clip.skeleton.reference[j].position - back.clip.skeleton.reference[j].position).norm(),
          1e-6);
    }
    for (std::size_t i = 0; i < clip.positions.size(); ++i) {
      ASSERT_LT((clip.positions[i] - back.clip.positions[i]).norm(), 2e-5f);
    }
    // BVH can store all that was read, so writing it again loses no channel and no significant
    // digit.
    const std::string again = written(back.clip, options);
    const Capture third = read_ok(again, reading);
    for (std::size_t i = 0; i < clip.positions.size(); ++i) {
      ASSERT_LT((third.clip.positions[i] - back.clip.positions[i]).norm(), 2e-5f);
    }
  }
}

}  // namespace
}  // namespace krok::bvh
