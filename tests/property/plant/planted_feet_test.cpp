// Laws of foot clean-up: what a root, a reference pose, the world's axes or an earlier clean-up are
// must not matter. If these fail, the same walk comes out differently from another exporter.

#include <gtest/gtest.h>

#include <cmath>

#include "math/quaternion.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "plant/plant_feet.h"
#include "samples/generator/gesture.h"
#include "support/foot_skate.h"
#include "support/planted_measures.h"

namespace krok {
namespace {

Clip sliding_walk(unsigned seed) {
  const auto walk = samples::make_walk(test::varied_walk(seed));
  EXPECT_TRUE(walk.ok());
  return test::with_skate(*walk, {.body_jitter = seed % 2 ? 0.002 : 0, .seed = seed});
}

PlantedFeet planted(const Clip& clip, std::optional<std::span<const Contact>> contacts = {}) {
  auto result = plant_feet(clip, find_roles(clip.skeleton), contacts);
  EXPECT_TRUE(result.ok());
  return result.ok() ? std::move(*result) : PlantedFeet{};
}

// With another root above the hips: on the ground below them, or one that never moves.
Clip with_root(const Clip& clip, bool moves) {
  Clip result;
  result.rate = clip.rate;
  result.skeleton.add("Reference", -1, {});
  for (int j = 0; j < clip.joint_count(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    result.skeleton.add(clip.skeleton.names[i], clip.skeleton.parents[i] + 1,
                        clip.skeleton.reference[i], clip.skeleton.end_sites[i] != 0);
  }
  result.resize(clip.frame_count());
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Vec3f hips = clip.frame_positions(f)[0];
    result.frame_positions(f)[0] = moves ? Vec3f(hips.x(), 0, hips.z()) : Vec3f::Zero();
    result.frame_orientations(f)[0] = Quatf::Identity();
    for (std::size_t j = 0; j < clip.skeleton.names.size(); ++j) {
      result.frame_positions(f)[j + 1] = clip.frame_positions(f)[j];
      result.frame_orientations(f)[j + 1] = clip.frame_orientations(f)[j];
    }
  }
  return result;
}

constexpr unsigned kWalks = 8;
constexpr double kSame = 0.0001;    // metres
constexpr double kTwice = 0.00005;  // metres

TEST(PlantedFeet, RootDoesNotMatter) {
  for (unsigned seed = 0; seed < kWalks; ++seed) {
    const Clip walk = sliding_walk(seed);
    const Clip expected = planted(walk).clip;
    for (const bool moves : {false, true}) {
      const Clip other = with_root(walk, moves);
      const Clip result = planted(other).clip;
      EXPECT_LT(test::apart(expected, result, 1), kSame) << seed;
      for (int f = 0; f < other.frame_count(); ++f) {
        EXPECT_EQ(other.frame_positions(f)[0], result.frame_positions(f)[0]);
      }
    }
  }
}

TEST(PlantedFeet, ReferencePoseDoesNotMatter) {
  for (unsigned seed = 0; seed < kWalks; ++seed) {
    const Clip walk = sliding_walk(seed);
    Clip lying = walk;
    const Transform turn{Vec3::Zero(), from_rotation_vector(Vec3(-kPi / 2, 0, 0))};
    for (Transform& joint : lying.skeleton.reference) joint = turn * joint;
    EXPECT_LT(test::apart(planted(walk).clip, planted(lying).clip), kSame) << seed;
  }
}

TEST(PlantedFeet, TurnedInputGivesTurnedOutput) {
  for (unsigned seed = 0; seed < kWalks; ++seed) {
    const Clip walk = sliding_walk(seed);
    const Transform turn{Vec3(1, 0, -2), from_rotation_vector(Vec3(0, 0.65 * kPi, 0))};
    Clip turned = walk;
    move_clip(turn, turned);
    Clip expected = planted(walk).clip;
    move_clip(turn, expected);
    // What is still by less than 0.0004 of a leg may be corrected or not.
    EXPECT_LT(test::apart(expected, planted(turned).clip), 0.0004) << seed;
  }
}

// Feet that stand stay as they are, whatever the rest of the body does.
TEST(PlantedFeet, WhoStandsStaysAsHeIs) {
  for (const samples::Gesture gesture : {samples::Gesture::wave, samples::Gesture::look}) {
    samples::GestureOptions options;
    options.gesture = gesture;
    const Clip clip = samples::make_gesture(options).value();
    EXPECT_LT(test::apart(clip, planted(clip).clip), kSame);
  }
}

// Nobody stands still to a tenth of a millimetre. If this fails, a stay of a body that sways falls
// into parts of a few frames, between which its feet jump.
TEST(PlantedFeet, WhoSwaysStandsAllTheWhile) {
  samples::GestureOptions options;
  options.rate = 120;
  Clip clip = samples::make_gesture(options).value();
  for (int f = 0; f < clip.frame_count(); ++f) {
    const double angle = 2 * kPi * 1.3 * f / clip.rate;
    const Vec3f sway(0.002F * static_cast<float>(std::sin(angle)), 0,
                     0.002F * static_cast<float>(std::cos(1.6 * angle)));
    for (Vec3f& position : clip.frame_positions(f)) position += sway;
  }
  const PlantedFeet result = planted(clip);
  EXPECT_LE(result.stays.size(), 6U);
  EXPECT_LT(result.drift_after, kTwice);
  EXPECT_LT(test::apart(result.clip, planted(result.clip).clip), kTwice);
}

// A second pass finds nothing to correct, with the same contacts and with contacts detected again.
// If this fails, a motion changes whenever a pipeline runs over its own results.
TEST(PlantedFeet, PlantedTwiceIsPlantedOnce) {
  for (unsigned seed = 0; seed < kWalks; ++seed) {
    const Clip walk = sliding_walk(seed);
    const auto found = find_contacts(walk, find_roles(walk.skeleton));
    ASSERT_TRUE(found.ok());
    const Clip once = planted(walk, found->contacts).clip;
    EXPECT_LT(test::apart(once, planted(once, found->contacts).clip), kTwice) << seed;
    const Clip detected = planted(walk).clip;
    EXPECT_LT(test::apart(detected, planted(detected).clip), kTwice) << seed;
  }
}

// Contacts of any kind, right or not: bones keep their lengths, and values stay finite.
TEST(PlantedFeet, NoContactsBreakBones) {
  std::mt19937 random(7);
  for (unsigned seed = 0; seed < 40; ++seed) {
    Clip walk = sliding_walk(seed % kWalks);
    if (seed % 4 == 0) walk = cut(walk, 0, static_cast<int>(seed / 4 % 4));
    const RoleMap roles = find_roles(walk.skeleton);
    std::vector<Contact> contacts;
    for (const Role role : {Role::left_foot, Role::left_toes, Role::right_foot, Role::right_toes}) {
      for (int i = 0; i < 3; ++i) {
        const double a = random() % 1000 / 1000.0 * walk.duration();
        const double b = random() % 1000 / 1000.0 * walk.duration();
        contacts.push_back({roles.joint(role), std::min(a, b), std::max(a, b), Vec3::Zero()});
      }
    }
    contacts.push_back({roles.joint(Role::left_foot), 0, walk.duration(), Vec3::Zero()});
    const auto result = plant_feet(walk, roles, contacts);
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_TRUE(check(result->clip).ok());
    for (int f = 0; f < walk.frame_count(); ++f) {
      for (int j = 1; j < walk.joint_count(); ++j) {
        const int parent = walk.skeleton.parents[static_cast<std::size_t>(j)];
        const auto length = [&](const Clip& clip) {
          return (test::joint_of(clip, f, j).position - test::joint_of(clip, f, parent).position)
              .norm();
        };
        ASSERT_NEAR(length(walk), length(result->clip), 5e-6) << seed << " " << f << " " << j;
      }
    }
  }
}

}  // namespace
}  // namespace krok
