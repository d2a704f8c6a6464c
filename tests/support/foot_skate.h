#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "contacts/contacts.h"
#include "math/quaternion.h"
#include "roles/roles.h"
#include "samples/generator/foot_slides.h"
#include "samples/generator/walk.h"
#include "scene/clip.h"

// Walks whose feet slide and jitter, and measures of what a clean-up makes of them.

namespace krok::test {

inline Transform joint_of(const Clip& clip, int frame, int joint) {
  return {
      clip.frame_positions(frame)[static_cast<std::size_t>(joint)].cast<double>(),
      clip.frame_orientations(frame)[static_cast<std::size_t>(joint)].cast<double>().normalized()};
}

using samples::LegRoles;
using samples::legs_of;
using samples::move_foot;
using samples::Stance;
using samples::stances_of;

struct Skate {
  double slide = 0.02;         // metres that a foot slides over a stance, and back in the swing
  double body_jitter = 0.005;  // metres, deviation of each axis, of the whole figure
  double foot_jitter = 0;      // the same, of each foot for itself
  unsigned seed = 1;
};

// From the first touch of any point of a foot to the last, as found.
inline std::vector<Stance> stances_of(const Clip& clip, const RoleMap& roles) {
  std::vector<Stance> stances;
  const auto found = find_contacts(clip, roles);
  if (!found) return stances;
  for (const std::size_t side : {0U, 1U}) {
    std::vector<Stance> own;
    for (const Stay& stay : found->stays) {
      const SolePoint& point = found->tracks[static_cast<std::size_t>(stay.track)].point;
      if (static_cast<std::size_t>(point.side) == side) own.push_back({side, stay.start, stay.end});
    }
    std::ranges::sort(own, {}, &Stance::start);
    for (const Stance& stance : own) {
      const bool again = !stances.empty() && stances.back().side == side &&
                         stance.start < stances.back().end + 0.1;
      if (again) {
        stances.back().end = std::max(stances.back().end, stance.end);
      } else {
        stances.push_back(stance);
      }
    }
  }
  return stances;
}

// Slides begin and end at rest, each in a direction of its own along the ground, and are taken back
// in the swing. Where a leg is too short for them they are less.
inline Clip with_skate(const Clip& clean, const std::vector<Stance>& stances, const Skate& skate) {
  Clip clip = clean;
  std::mt19937 random(skate.seed);
  std::normal_distribution<double> normal;
  const auto vector = [&](double size) {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Vec3(size * Vec3(x, y, z));
  };
  const auto legs = legs_of(find_roles(clip.skeleton));
  std::vector<Vec3> directions;
  for (std::size_t i = 0; i < stances.size(); ++i) {
    const double angle = 2 * kPi * static_cast<double>(random()) / 4294967296.0;
    directions.emplace_back(std::sin(angle), 0, std::cos(angle));
  }
  for (int f = 0; f < clip.frame_count(); ++f) {
    const double time = f / clip.rate;
    for (const std::size_t side : {0U, 1U}) {
      Vec3 shift = vector(skate.foot_jitter);
      shift += skate.slide * samples::slide_at(stances, directions, side, time);
      samples::move_foot_within_reach(clip, f, legs[side], shift);
    }
    const Vec3f all = vector(skate.body_jitter).cast<float>();
    for (Vec3f& position : clip.frame_positions(f)) position += all;
  }
  return clip;
}
inline Clip with_skate(const samples::Walk& walk, const Skate& skate) {
  return with_skate(walk.clip, stances_of(walk), skate);
}

// The generator's walks over its whole range: lengths, turns, slopes, stairs, statures and rates.
inline samples::WalkOptions varied_walk(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  samples::WalkOptions options;
  options.steps = 10;
  options.stature = uniform(1.5, 1.95);
  options.step_length = uniform(0.4, 0.85) * options.stature / 1.75;
  options.step_width = uniform(0.06, 0.2);
  options.turn = random() % 3 == 0 ? uniform(-0.4, 0.4) : 0;
  const unsigned ground = random() % 4;
  if (ground == 0) options.rise = uniform(-0.05, 0.05);
  options.ground = samples::Ground::slope;
  options.from_standing = random() % 4 == 0;
  options.rate = std::array{30.0, 60.0, 60.0, 100.0, 120.0}[random() % 5];
  return options;
}

// Degrees a second squared, over all frames of both knees, of the bend between thigh and shank.
struct KneeAcceleration {
  double percentile_99 = 0, max = 0;
};
inline KneeAcceleration knee_acceleration(const Clip& clip, const RoleMap& roles, int first = 0) {
  std::vector<double> all;
  for (const LegRoles& leg : legs_of(roles)) {
    std::vector<double> bend;
    for (int f = first; f < clip.frame_count(); ++f) {
      const Vec3 hip = joint_of(clip, f, leg.upper).position,
                 knee = joint_of(clip, f, leg.lower).position,
                 ankle = joint_of(clip, f, leg.foot).position;
      const Vec3 thigh = knee - hip, shank = ankle - knee;
      bend.push_back(std::atan2(thigh.cross(shank).norm(), thigh.dot(shank)) / kRadiansPerDegree);
    }
    for (std::size_t f = 2; f < bend.size(); ++f) {
      all.push_back(std::abs(bend[f] - 2 * bend[f - 1] + bend[f - 2]) * clip.rate * clip.rate);
    }
  }
  if (all.empty()) return {};
  std::ranges::sort(all);
  return {all[static_cast<std::size_t>(0.99 * static_cast<double>(all.size() - 1))], all.back()};
}

}  // namespace krok::test
