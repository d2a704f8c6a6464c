// If these fail, a heel that has just left the ground, or is about to come down, counts as standing
// beside the ends of a clip, and foot clean-up holds it in the air; or a clip that starts while a
// foot rolls over its heel has a strike that nobody made, and its cycles are cut there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contacts/contacts.h"
#include "events.h"
#include "motion/sample.h"
#include "samples/generator/walk.h"

namespace krok {
namespace {

constexpr double kRate = 60;

std::vector<samples::Walk> walks_of(int steps) {
  std::vector<samples::Walk> walks;
  for (const double length : {0.45, 0.6, 0.75}) {
    samples::WalkOptions options;
    options.steps = steps;
    options.step_length = length;
    options.rate = kRate;
    auto walk = samples::make_walk(options);
    EXPECT_TRUE(walk.ok());
    walks.push_back(std::move(*walk));
  }
  return walks;
}

// How high, in metres above its place, the heel of a print is found to stand in a part of the walk
// that begins or ends beside its stance.
double highest_stand(const samples::Walk& walk, const samples::Footprint& print, int first,
                     int last) {
  const Clip part = cut(walk.clip, first, last);
  const auto found = find_contacts(part, find_roles(part.skeleton));
  EXPECT_TRUE(found.ok());
  double highest = -1;
  for (const Stay& stay : found->stays) {
    const SolePoint& point = found->tracks[static_cast<std::size_t>(stay.track)].point;
    const double start = stay.start + first / kRate, end = stay.end + first / kRate;
    if (point.part != FootPart::heel ||
        static_cast<int>(point.side) != static_cast<int>(print.side) || end < print.strike ||
        start > print.heel_rise) {
      continue;
    }
    const std::vector<Vec3> track = track_of(part, point, found->leg_length);
    for (const double time : {stay.start, stay.end}) {
      const auto frame = static_cast<std::size_t>(std::lround(time * kRate));
      highest = std::max(highest, track[std::min(frame, track.size() - 1)].y() - stay.place.y());
    }
  }
  return highest;
}

TEST(ContactsAtClipEnds, HeelsInTheAirDoNotStand) {
  int tested = 0;
  double worst = 0;
  for (const samples::Walk& walk : walks_of(8)) {
    for (const samples::Footprint& print : walk.prints) {
      const int rise = static_cast<int>(std::ceil(print.heel_rise * kRate)),
                strike = static_cast<int>(std::floor(print.strike * kRate));
      for (int frames = 4; frames <= 12; ++frames) {
        const int last = rise + frames, first = strike - frames;
        for (const auto& [from, to] :
             {std::pair(std::max(0, last - 90), last),
              std::pair(first, std::min(first + 90, walk.clip.frame_count() - 1))}) {
          if (from < 0 || to >= walk.clip.frame_count() || to - from < 60) continue;
          const double metres = highest_stand(walk, print, from, to);
          tested += metres >= 0 ? 1 : 0;
          worst = std::max(worst, metres);
        }
      }
    }
  }
  EXPECT_GT(tested, 150);
  EXPECT_LT(worst, 0.008);
}

// The walk with ankles that are captured too far back and up, as many are: the heel is then placed
// behind the true one, and moves slowly while the foot rolls over that.
Clip with_misplaced_ankles(const Clip& clip, double metres) {
  Clip result = clip;
  for (int j = 0; j < clip.joint_count(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    if (!clip.skeleton.names[i].ends_with("Foot")) continue;
    const Vec3 shift =
        clip.skeleton.reference[i].orientation.conjugate() * Vec3(0, metres, -metres);
    for (int f = 0; f < clip.frame_count(); ++f) {
      result.frame_positions(f)[i] += clip.frame_orientations(f)[i] * shift.cast<float>();
    }
  }
  return result;
}

TEST(GaitAtClipEnds, StrikesBeforeTheStartAreNotPlacedAfterIt) {
  int tested = 0, invented = 0, missed = 0;
  for (const samples::Walk& walk : walks_of(10)) {
    const Clip clip = with_misplaced_ankles(walk.clip, 0.05);
    for (int first = 60; first < 140; first += 3) {
      const Clip part = cut(clip, first, clip.frame_count() - 1);
      const auto keytimes = test::keytimes_of(part);
      for (const std::size_t side : {0, 1}) {
        const auto found = test::times_of(keytimes, side == 0 ? "left_strike" : "right_strike");
        const auto near = [](const std::vector<double>& times, double time) {
          return std::ranges::any_of(times, [&](double t) { return std::abs(t - time) < 0.035; });
        };
        for (const double time : found) {
          ++tested;
          invented += near(walk.feet[side].strikes, time + first / kRate) ? 0 : 1;
        }
        for (const double strike : walk.feet[side].strikes) {
          const double time = strike - first / kRate;
          missed += time > 0.02 && !near(found, time) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(tested, 300);
  EXPECT_LE(invented, 1);
  EXPECT_LE(missed, 1);
}

// Captures that end as a person stops, or as smoothing slows the last frames: a foot behind the
// body was taken for one that strikes, and made a cycle of two thirds of the others.
TEST(GaitAtClipEnds, AFootThatSlowsDownInItsSwingDoesNotStrike) {
  int tested = 0;
  for (const samples::Walk& walk : walks_of(8)) {
    const Clip clip = with_misplaced_ankles(walk.clip, 0.02);
    for (int last = 150; last < 230; last += 3) {
      Clip part = cut(clip, 0, last);
      const int frames = part.frame_count();
      part.resize(frames + 6);
      for (int f = frames; f < part.frame_count(); ++f) {
        std::vector<Transform> pose(part.skeleton.names.size());
        clip.get_pose(last + 1, pose);
        part.set_pose(f, pose);
      }
      const auto keytimes = test::keytimes_of(part);
      for (const std::size_t side : {0, 1}) {
        for (const double time :
             test::times_of(keytimes, side == 0 ? "left_strike" : "right_strike")) {
          ++tested;
          const bool near = std::ranges::any_of(walk.feet[side].strikes, [&](double strike) {
            return std::abs(strike - time) < 0.2;
          });
          EXPECT_TRUE(near) << last << ": " << time;
        }
      }
    }
  }
  EXPECT_GT(tested, 200);
}

}  // namespace
}  // namespace krok
