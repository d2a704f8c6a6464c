#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "parametric/cut_steps.h"
#include "samples/generator/walk.h"

// Walks of which everything is known, and libraries cut out of them.

namespace krok::parametric::test {

// The keytimes of a walk as it was planned, as far as they lie within the clip.
inline MotionKeys planned_keys(const samples::Walk& walk) {
  MotionKeys keys;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    const auto& foot = walk.feet[static_cast<std::size_t>(side)];
    const auto add = [&](const std::vector<double>& times, const char* what) {
      for (const double time : times) {
        if (time < -1e-9 || time > walk.clip.duration() + 1e-9) continue;
        keys.keytimes.push_back(
            {std::clamp(time, 0.0, walk.clip.duration()), std::string(name_of(side)) + what});
      }
    };
    add(foot.strikes, "_strike");
    add(foot.offs, "_off");
  }
  std::ranges::sort(keys.keytimes, {}, &Keytime::time);
  return keys;
}

// A walk with its keys, in a place of its own so that it may be pointed to.
struct KeyedWalk {
  samples::Walk walk;
  MotionKeys keys;
  FoundContacts found;
};
inline KeyedWalk keyed_walk(const samples::WalkOptions& options) {
  KeyedWalk result;
  auto walk = samples::make_walk(options);
  EXPECT_TRUE(walk.ok()) << walk.error().message;
  result.walk = *std::move(walk);
  result.keys = planned_keys(result.walk);
  auto found = find_contacts(result.walk.clip, find_roles(result.walk.clip.skeleton));
  EXPECT_TRUE(found.ok());
  result.found = *std::move(found);
  result.keys.contacts = result.found.contacts;
  return result;
}

// The plan of the step that ends with the strike at `time`: length, width, height, turn as
// Parameter has them.
struct PlannedStep {
  FootSide swing = FootSide::left;
  double length = 0, width = 0, height = 0, turn = 0, duration = 0;
};
inline PlannedStep planned_step(const samples::Walk& walk, double time) {
  const samples::Footprint *stance = nullptr, *swing = nullptr;
  for (const auto& print : walk.prints) {
    if (print.first_of_foot && print.strike < 0) continue;
    if (std::abs(print.strike - time) < 1e-3) swing = &print;
    if (std::abs(print.strike - (time - walk.step_time)) < 1e-3) stance = &print;
  }
  EXPECT_TRUE(stance != nullptr && swing != nullptr) << time;
  PlannedStep step;
  if (stance == nullptr || swing == nullptr) return step;
  step.swing = swing->side == samples::Side::left ? FootSide::left : FootSide::right;
  const double side = step.swing == FootSide::left ? 1 : -1;
  const Vec3 way = axis_rotation(Axis::y, -stance->heading) * Vec3(swing->heel - stance->heel);
  step.length = way.z();
  step.width = side * way.x();
  step.height = way.y();
  step.turn = side * wrapped(swing->heading - stance->heading);
  step.duration = walk.step_time;
  return step;
}

inline const std::vector<std::string> kStepParameters = {"step.length", "step.width", "step.height",
                                                         "step.turn", "duration"};

inline StepLibrary library_of(const std::vector<KeyedWalk>& walks,
                              const std::vector<std::string>& parameters,
                              const CutOptions& options = {}) {
  std::vector<Walk> given;
  for (std::size_t i = 0; i < walks.size(); ++i) {
    given.push_back(
        {"walk" + std::to_string(i), &walks[i].walk.clip, &walks[i].keys, &walks[i].found});
  }
  auto cut = cut_steps(given, find_roles(walks.front().walk.clip.skeleton), parameters, options);
  EXPECT_TRUE(cut.ok()) << cut.error().message;
  return cut.ok() ? *std::move(cut) : StepLibrary();
}

// One step to the left for each combination: 3 lengths by 3 heights, and by 3 turns where `turns`.
inline std::vector<KeyedWalk> grid_walks(bool turns) {
  std::vector<KeyedWalk> walks;
  for (const double turn : turns ? std::vector{-0.3, 0.0, 0.3} : std::vector{0.0}) {
    for (const double length : {0.45, 0.6, 0.75}) {
      for (const double rise : {-0.12, 0.0, 0.12}) {
        samples::WalkOptions options;
        options.steps = 2;
        options.step_length = length;
        options.rise = rise;
        options.turn = turn;
        walks.push_back(keyed_walk(options));
      }
    }
  }
  return walks;
}

}  // namespace krok::parametric::test
