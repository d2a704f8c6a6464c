// Steps of takes that are read in parts. If these fail, an hour's capture has other steps than its
// minutes: events at the borders of parts are lost or twice, or one stance becomes two contacts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contacts/contacts.h"
#include "contacts/gait_keytimes.h"
#include "contacts/long_take.h"
#include "contacts/sole_points.h"
#include "samples/generator/walk.h"

namespace krok {
namespace {

struct TakeInParts {
  Clip clip;
  RoleMap roles;
  std::vector<Contact> contacts;
  std::vector<Keytime> keytimes;

  explicit TakeInParts(double rate) {
    samples::WalkOptions options;
    options.steps = 80;
    options.rate = rate;
    clip = samples::make_walk(options).value().clip;
    roles = find_roles(clip.skeleton);
    auto found = find_contacts(clip, roles).value();
    keytimes = find_gait(clip, roles, found).keytimes;
    contacts = std::move(found.contacts);
  }
  LongTake in_parts(int part, int jobs = 1) const {
    return find_in_long_take(frames_of(clip), roles, jobs, nullptr, {.part = part, .margin = 4})
        .value();
  }
};

TEST(LongTakes, OnePartIsTheWhole) {
  const TakeInParts take(60);
  const LongTake found = take.in_parts(take.clip.frame_count());
  ASSERT_EQ(found.keys.keytimes.size(), take.keytimes.size());
  for (std::size_t i = 0; i < take.keytimes.size(); ++i) {
    EXPECT_EQ(found.keys.keytimes[i].time, take.keytimes[i].time);
    EXPECT_EQ(found.keys.keytimes[i].name, take.keytimes[i].name);
  }
  ASSERT_EQ(found.keys.contacts.size(), take.contacts.size());
  for (std::size_t i = 0; i < take.contacts.size(); ++i) {
    EXPECT_EQ(found.keys.contacts[i].joint, take.contacts[i].joint);
    EXPECT_EQ(found.keys.contacts[i].end, take.contacts[i].end);
    EXPECT_EQ(found.keys.contacts[i].place, take.contacts[i].place);
  }
  const StepMeasures whole = step_measures(take.clip, take.roles, take.keytimes);
  EXPECT_EQ(found.steps.steps, whole.steps);
  EXPECT_NEAR(*found.steps.speed, *whole.speed, 1e-12);
  EXPECT_NEAR(found.slide_speed, slide_speed(take.clip, take.roles), 1e-12);
}

TEST(LongTakes, ManyPartsHaveTheSameSteps) {
  for (const double rate : {60.0, 120.0}) {
    const TakeInParts take(rate);
    for (const int part : {200, 333, 1000}) {
      const LongTake found = take.in_parts(part);
      ASSERT_EQ(found.keys.keytimes.size(), take.keytimes.size()) << rate << " " << part;
      for (std::size_t i = 0; i < take.keytimes.size(); ++i) {
        EXPECT_EQ(found.keys.keytimes[i].name, take.keytimes[i].name) << i;
        EXPECT_NEAR(found.keys.keytimes[i].time, take.keytimes[i].time, 0.5 / rate) << i;
      }
      ASSERT_EQ(found.keys.contacts.size(), take.contacts.size()) << rate << " " << part;
      for (std::size_t i = 0; i < take.contacts.size(); ++i) {
        EXPECT_EQ(found.keys.contacts[i].joint, take.contacts[i].joint);
        EXPECT_NEAR(found.keys.contacts[i].start, take.contacts[i].start, 0.5 / rate);
        EXPECT_NEAR(found.keys.contacts[i].end, take.contacts[i].end, 0.5 / rate);
      }
      // The shortest parts have no stride.
      if (part < 1000) continue;
      ASSERT_TRUE(found.steps.speed);
      EXPECT_NEAR(*found.steps.speed, *step_measures(take.clip, take.roles, take.keytimes).speed,
                  0.005);
    }
  }
}

// A foot contact that is longer than a part with its margins is found once.
TEST(LongTakes, AStanceOverManyPartsIsOneContact) {
  const TakeInParts take(60);
  Clip still = take.clip;
  still.resize(0);
  still.resize(3000);
  const int middle = take.clip.frame_count() / 2;
  for (int f = 0; f < still.frame_count(); ++f) {
    std::ranges::copy(take.clip.frame_positions(middle), still.frame_positions(f).begin());
    std::ranges::copy(take.clip.frame_orientations(middle), still.frame_orientations(f).begin());
  }
  const auto whole = find_contacts(still, take.roles).value().contacts;
  const auto found =
      find_in_long_take(frames_of(still), take.roles, 1, nullptr, {.part = 300, .margin = 2})
          .value();
  ASSERT_FALSE(whole.empty());
  ASSERT_EQ(found.keys.contacts.size(), whole.size());
  for (const Contact& contact : found.keys.contacts) {
    EXPECT_EQ(contact.start, 0);
    EXPECT_NEAR(contact.end, still.duration(), 1e-9);
  }
}

TEST(LongTakes, ThreadsDoNotMatter) {
  const TakeInParts take(60);
  const LongTake one = take.in_parts(250), three = take.in_parts(250, 3);
  ASSERT_EQ(one.keys.keytimes.size(), three.keys.keytimes.size());
  for (std::size_t i = 0; i < one.keys.keytimes.size(); ++i) {
    EXPECT_EQ(one.keys.keytimes[i].time, three.keys.keytimes[i].time);
  }
  EXPECT_EQ(one.slide_speed, three.slide_speed);
  EXPECT_EQ(*one.steps.step_width, *three.steps.step_width);
}

}  // namespace
}  // namespace krok
