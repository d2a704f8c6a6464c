// If these fail, a long take is planted whole, in more memory than there is, or its parts do not
// meet: the body jumps, or a foot that stands is moved.

#include "plant/long_take.h"

#include <gtest/gtest.h>

#include <numeric>

#include "contacts/legs.h"
#include "core/index.h"
#include "motion/travel.h"
#include "support/planted_measures.h"

namespace krok {
namespace {

constexpr int kPart = 1500;  // frames

struct LongWalk {
  Clip clip;
  RoleMap roles;

  LongWalk() {
    samples::WalkOptions options;
    options.steps = 120;
    options.rate = 60;
    clip = test::with_skate(samples::make_walk(options).value(), {});
    roles = find_roles(clip.skeleton);
    EXPECT_GT(clip.frame_count(), 2 * kPart);
  }

  PlantedFeet in_parts(int part_frames, int longest) const {
    const auto plant = [&](const Clip& part, const auto& contacts) {
      EXPECT_LE(part.frame_count(), longest);
      std::optional<std::span<const Contact>> given;
      if (contacts) given = *contacts;
      return plant_feet(part, roles, given);
    };
    const PlantedFrames planted = plant_long_take(frames_of(clip), {}, {}, 2, plant,
                                                  at(part_frames * clip.joint_count() * 28));
    auto made = load(planted.frames, 1);
    EXPECT_TRUE(made.ok());
    PlantedFeet feet = planted.done();
    feet.clip = *std::move(made);
    return feet;
  }
};

TEST(PlantLongTake, OnePartIsTheWhole) {
  const LongWalk walk;
  const PlantedFeet found = walk.in_parts(100000, walk.clip.frame_count());
  const PlantedFeet whole = plant_feet(walk.clip, walk.roles).value();
  EXPECT_EQ(found.clip.positions, whole.clip.positions);
  EXPECT_EQ(found.stays.size(), whole.stays.size());
  EXPECT_EQ(found.rolls.size(), whole.rolls.size());
  EXPECT_EQ(found.drift_before, whole.drift_before);
  EXPECT_EQ(found.drift_after, whole.drift_after);
  EXPECT_NEAR(found.body_steadied, whole.body_steadied, 1e-12);
  EXPECT_EQ(found.stance_share, whole.stance_share);
}

TEST(PlantLongTake, PartsMeet) {
  const LongWalk walk;
  const PlantedFeet feet = walk.in_parts(kPart, kPart + 2 * 600);
  const PlantedFeet whole = plant_feet(walk.clip, walk.roles).value();
  EXPECT_NEAR(static_cast<double>(feet.stays.size()), static_cast<double>(whole.stays.size()), 4);
  EXPECT_GT(feet.drift_before, 0.02);
  EXPECT_LT(feet.drift_after, 0.001);
  for (const FixedStay& stay : feet.stays) {
    if (stay.point.part == FootPart::tip) continue;
    const auto place = [&](int frame) -> Vec3 {
      return joint_at(feet.clip, frame, stay.point.joint) * stay.point.offset;
    };
    for (int f = stay.first; f <= stay.last; ++f) {
      ASSERT_LT((place(f) - place(stay.first)).norm(), feet.drift_after + 1e-6) << f;
    }
  }
  std::vector<int> all(walk.clip.skeleton.names.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_LT(largest_displacement(feet.clip, whole.clip, all).distance, 0.02);
}

}  // namespace
}  // namespace krok
