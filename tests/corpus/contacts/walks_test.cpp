// Walks of real people from several exporters. Nobody measured when their feet touched, so what is
// found is held against what gait analysis knows of all walks (Perry and Burnfield, "Gait
// Analysis"; Winter): feet take turns, a foot is down for a little over half of the cycle, both are
// for some of it, left and right are much alike. If these fail, blends of captures fall out of
// step.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "contacts/gait_keytimes.h"
#include "contacts/gait_metrics.h"
#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "support/this_build.h"

namespace krok {
namespace {

struct Found {
  Clip clip;
  FoundContacts contacts;
  Gait gait;
};

// Skips the test where there is no corpus.
#define FIND_OR_SKIP(found, name)                                      \
  const std::string path = test::corpus_folder() + "/bvh/" + (name);   \
  if (!std::filesystem::exists(path))                                  \
    GTEST_SKIP() << "skipped: no corpus at " << test::corpus_folder(); \
  const Found found = find(path)

Found find(const std::string& path) {
  Found found;
  const auto file = InputFile::open(path);
  EXPECT_TRUE(file.ok());
  auto capture = bvh::read(file->text(), path, {});
  EXPECT_TRUE(capture.ok());
  found.clip = std::move(capture->clip);
  const RoleMap roles = find_roles(found.clip.skeleton);
  auto contacts = find_contacts(found.clip, roles);
  EXPECT_TRUE(contacts.ok());
  found.contacts = std::move(*contacts);
  found.gait = find_gait(found.clip, roles, found.contacts);
  EXPECT_TRUE(check({found.contacts.contacts, found.gait.keytimes}, found.clip.skeleton,
                    found.clip.duration())
                  .ok());
  return found;
}

std::string name_of_file(const testing::TestParamInfo<const char*>& test_case) {
  std::string name = test_case.param;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
}

class Walks : public testing::TestWithParam<const char*> {};

TEST_P(Walks, AreAsGaitAnalysisHasThem) {
  FIND_OR_SKIP(found, GetParam());
  const GaitMetrics gait = gait_metrics(found.gait.keytimes);
  EXPECT_GE(gait.cycles, 2);
  EXPECT_GT(gait.cadence, 80);
  EXPECT_LT(gait.cadence, 135);
  for (const double stance : gait.stance) {
    EXPECT_GT(stance, 0.55);
    EXPECT_LT(stance, 0.70);
  }
  EXPECT_NEAR(gait.stance[0], gait.stance[1], 0.06);
  EXPECT_GT(gait.double_support, 0.1);
  EXPECT_LT(gait.double_support, 0.36);
  // One foot's strike, the other's, in turn.
  std::string last;
  for (const Keytime& key : found.gait.keytimes) {
    if (!key.name.ends_with("strike")) continue;
    EXPECT_NE(key.name, last) << key.time;
    last = key.name;
  }
  EXPECT_LE(found.gait.from_seeds, 2);
}

INSTANTIATE_TEST_SUITE_P(Files, Walks,
                         testing::Values("walkset_cmu07/007_02.bvh", "walkset_cmu07/007_06.bvh",
                                         "walkset_cmu07/007_09.bvh", "pybvh/cmu_12_01_walk.bvh",
                                         "optitrack_arena_bvh-matlab/walk.bvh",
                                         "makehuman/12_03.bvh",
                                         "pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh",
                                         "iclone_cmu/002_01.bvh",
                                         "deep-motion-editing/xia_test_neutral_01_000.bvh"),
                         name_of_file);

// The moments at which a joint is furthest behind the hips (or before them) on a straight way, by
// themselves: Zeni, Richards and Higginson (2008) found strikes and offs within a frame of them, on
// force plates.
std::vector<double> turns(const Clip& clip, const RoleMap& roles, Role role, bool front) {
  const auto joint = static_cast<std::size_t>(roles.joint(role));
  const auto hips = static_cast<std::size_t>(roles.joint(Role::hips));
  const int last = clip.frame_count() - 1, reach = static_cast<int>(0.3 * clip.rate);
  Vec3f way = clip.frame_positions(last)[hips] - clip.frame_positions(last / 4)[hips];
  way.y() = 0;
  std::vector<float> ahead;
  for (int f = 0; f <= last; ++f) {
    ahead.push_back((clip.frame_positions(f)[joint] - clip.frame_positions(f)[hips])
                        .dot(front ? way : Vec3f(-way)));
  }
  std::vector<double> times;
  for (int f = reach; f + reach <= last; ++f) {
    const auto around = ahead.begin() + f;
    if (std::max_element(around - reach, around + reach + 1) == around) {
      times.push_back(f / clip.rate);
    }
  }
  return times;
}

class StraightWalks : public testing::TestWithParam<const char*> {};

TEST_P(StraightWalks, EventsAreWhereTheFeetTurnBeforeAndBehindTheHips) {
  FIND_OR_SKIP(found, GetParam());
  const RoleMap roles = find_roles(found.clip.skeleton);
  int offs = 0, near_offs = 0, strikes = 0, near_strikes = 0;
  for (const bool left : {true, false}) {
    const auto fronts = turns(found.clip, roles, left ? Role::left_foot : Role::right_foot, true);
    const auto backs = turns(found.clip, roles, left ? Role::left_toes : Role::right_toes, false);
    for (const Keytime& key : found.gait.keytimes) {
      if (key.name.starts_with("left") != left) continue;
      const bool strike = key.name.ends_with("strike");
      for (const double turn : strike ? fronts : backs) {
        const double after = key.time - turn;
        if (std::abs(after) > 0.2) continue;
        // The ankle turns before the heel does, and that before it is stopped.
        if (strike) ++strikes, near_strikes += after > -0.01 && after < 0.08 ? 1 : 0;
        if (!strike) ++offs, near_offs += std::abs(after) < 0.035 ? 1 : 0;
      }
    }
  }
  EXPECT_GE(strikes, 3);
  EXPECT_GE(offs, 3);
  EXPECT_GE(near_strikes, 0.8 * strikes);
  EXPECT_GE(near_offs, 0.8 * offs);
}

INSTANTIATE_TEST_SUITE_P(Files, StraightWalks,
                         testing::Values("walkset_cmu07/007_02.bvh", "walkset_cmu07/007_06.bvh",
                                         "walkset_cmu07/007_09.bvh", "walkset_cmu07/007_10.bvh",
                                         "iclone_cmu/002_01.bvh",
                                         "optitrack_arena_bvh-matlab/walk.bvh"),
                         name_of_file);

// A capture kept at a lower rate has its strikes where they were. Would fail if they came later the
// lower the rate is: at 30 Hz it was half a frame.
TEST(WalksAtLowerRates, HaveTheirStrikesWhereTheyWere) {
  for (const double rate : {60.0, 30.0}) {
    std::vector<double> errors;
    for (const char* name : {"007_02", "007_03", "007_06", "007_09", "007_10", "007_12"}) {
      FIND_OR_SKIP(found, std::string("walkset_cmu07/") + name + ".bvh");
      const int step = static_cast<int>(std::lround(found.clip.rate / rate));
      Clip thin;
      thin.skeleton = found.clip.skeleton;
      thin.rate = found.clip.rate / step;
      thin.resize((found.clip.frame_count() - 1) / step + 1);
      for (int f = 0; f < thin.frame_count(); ++f) {
        std::ranges::copy(found.clip.frame_positions(f * step), thin.frame_positions(f).begin());
        std::ranges::copy(found.clip.frame_orientations(f * step),
                          thin.frame_orientations(f).begin());
      }
      const RoleMap roles = find_roles(thin.skeleton);
      const auto contacts = find_contacts(thin, roles);
      ASSERT_TRUE(contacts.ok());
      const Gait gait = find_gait(thin, roles, *contacts);
      for (const Keytime& key : found.gait.keytimes) {
        if (!key.name.ends_with("strike") || key.time < 0.1) continue;
        double error = 1;
        for (const Keytime& other : gait.keytimes) {
          const double apart = other.time - key.time;
          if (other.name == key.name && std::abs(apart) < std::abs(error)) error = apart;
        }
        errors.push_back(error);
      }
    }
    std::ranges::sort(errors);
    ASSERT_GE(errors.size(), 24U);
    EXPECT_NEAR(errors[errors.size() / 2], 0, 0.004) << rate;
    const auto near =
        std::ranges::count_if(errors, [](double error) { return std::abs(error) <= 1.0 / 60; });
    EXPECT_GE(static_cast<double>(near), 0.85 * static_cast<double>(errors.size())) << rate;
  }
}

// In a run no two feet are down at once.
TEST(Run, HasFlight) {
  FIND_OR_SKIP(found, "iclone_cmu/002_03.bvh");
  const GaitMetrics gait = gait_metrics(found.gait.keytimes);
  EXPECT_GT(gait.cadence, 140);
  for (const double stance : gait.stance) {
    EXPECT_GT(stance, 0.25);
    EXPECT_LT(stance, 0.45);
  }
}

// A man on a bicycle: after he has mounted, no foot stands for a quarter of a minute but where he
// stops pedalling.
TEST(Bicycle, HasNoGait) {
  FIND_OR_SKIP(found, "optitrack_arena_bvh-matlab/louise.bvh");
  int pedalled = 0;
  for (const Keytime& key : found.gait.keytimes) {
    if (key.time > 10.5 && key.time < 22) ++pedalled;
  }
  EXPECT_EQ(pedalled, 0);
}

// Breakdance on the hands: feet that swing a metre over the floor do not strike it.
TEST(Breakdance, FeetInTheAirDoNotStrike) {
  FIND_OR_SKIP(found, "animated_drawings/rokoko_jesse_dance.bvh");
  int in_the_air = 0;
  for (const Keytime& key : found.gait.keytimes) {
    if (key.time > 2.2 && key.time < 8.5) ++in_the_air;
  }
  EXPECT_LE(in_the_air, 4);
  for (const Contact& contact : found.contacts.contacts) {
    EXPECT_LT(contact.place.y() - found.contacts.contacts.front().place.y(), 0.3);
  }
}

}  // namespace
}  // namespace krok
