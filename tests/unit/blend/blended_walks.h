#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "blend/blend_clips.h"
#include "roles/roles.h"
#include "samples/generator/walk.h"

// Walks with known keytimes, for tests of blending.

namespace krok::blend {

struct KeyedWalk {
  Clip clip;
  MotionKeys keys;
};

inline KeyedWalk keyed_walk(const samples::WalkOptions& options) {
  const auto walk = samples::make_walk(options);
  EXPECT_TRUE(walk.ok());
  KeyedWalk result{walk->clip, {}};
  for (const auto side : {samples::Side::left, samples::Side::right}) {
    const samples::FootContacts& foot = walk->feet[static_cast<std::size_t>(side)];
    const std::string name = side == samples::Side::left ? "left" : "right";
    const std::string joint = side == samples::Side::left ? "Left" : "Right";
    for (const double time : foot.strikes) result.keys.keytimes.push_back({time, name + "_strike"});
    for (const double time : foot.offs) result.keys.keytimes.push_back({time, name + "_off"});
    const auto add = [&](const std::vector<samples::Contact>& stays, const std::string& of) {
      for (const samples::Contact& stay : stays) {
        const int index = walk->clip.skeleton.find(of);
        EXPECT_GE(index, 0) << of;
        // The plan may end a part of a frame behind the last one.
        const double end = std::min(stay.to, walk->clip.duration());
        if (stay.from <= end) result.keys.contacts.push_back({index, stay.from, end, stay.place});
      }
    };
    add(foot.heel, joint + "Foot");
    add(foot.toe, joint + "ToeBase");
  }
  for (Keytime& key : result.keys.keytimes) key.time = std::min(key.time, walk->clip.duration());
  std::ranges::sort(result.keys.keytimes, {}, &Keytime::time);
  // A walk that is cut out of a longer one begins and ends with a strike.
  auto& keytimes = result.keys.keytimes;
  for (std::size_t i = 1; i < keytimes.size();) {
    if (keytimes[i].time < keytimes[i - 1].time + 1e-5) {
      keytimes.erase(keytimes.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  std::ranges::sort(result.keys.contacts, {}, &Contact::start);
  EXPECT_TRUE(check(result.keys, result.clip.skeleton, result.clip.duration()).ok());
  return result;
}

inline samples::WalkOptions slow_walk() {
  samples::WalkOptions options;
  options.steps = 6;
  options.step_length = 0.5;
  options.cadence = 84;
  return options;
}

inline samples::WalkOptions quick_walk() {
  samples::WalkOptions options;
  options.steps = 6;
  options.step_length = 0.8;
  options.cadence = 126;
  return options;
}

inline BlendInput input_of(const KeyedWalk& walk, const WeightCurve& weight) {
  return {"walk", &walk.clip, &walk.keys, weight};
}

inline Correspondence keytimes_of(const std::vector<BlendInput>& inputs) {
  std::vector<KeyedMotion> motions;
  for (const BlendInput& input : inputs) {
    motions.push_back({input.name, input.clip->duration(), input.keys, 2.1 / input.clip->rate});
  }
  const auto found = match_keytimes(motions);
  EXPECT_TRUE(found.ok()) << (found.ok() ? "" : found.error().message);
  return *found;
}

inline Correspondence ends_of(const std::vector<BlendInput>& inputs) {
  std::vector<double> durations;
  for (const BlendInput& input : inputs) durations.push_back(input.clip->duration());
  return *ends_alone(durations);
}

inline Blended blended(const std::vector<BlendInput>& inputs, const Correspondence& moments,
                       const BlendOptions& options = {}) {
  const RoleMap roles = find_roles(inputs.front().clip->skeleton);
  const auto result = blend_clips(inputs, roles, moments, options);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return result.ok() ? *result : Blended();
}

// Metres; frames that one of them lacks are not looked at.
inline double farthest(const Clip& a, const Clip& b) {
  double most = 0;
  const std::size_t count = std::min(a.positions.size(), b.positions.size());
  for (std::size_t i = 0; i < count; ++i) {
    most = std::max<double>(most, (a.positions[i] - b.positions[i]).norm());
  }
  return most;
}

// How fast the slower of both toe joints goes along the ground, in the mean over some frames: one
// of them always stands in a walk. Metres a second.
inline double slide(const Clip& clip, int first, int last) {
  double sum = 0;
  for (int f = first + 1; f <= last; ++f) {
    double slower = HUGE_VAL;
    for (const char* name : {"LeftToeBase", "RightToeBase"}) {
      const auto toe = static_cast<std::size_t>(clip.skeleton.find(name));
      Vec3f way = clip.frame_positions(f)[toe] - clip.frame_positions(f - 1)[toe];
      way.y() = 0;
      slower = std::min<double>(slower, way.norm() * clip.rate);
    }
    sum += slower;
  }
  return sum / (last - first);
}
inline double slide(const Clip& clip) {
  return slide(clip, 0, clip.frame_count() - 1);
}

}  // namespace krok::blend
