#pragma once

#include <string>
#include <vector>

#include "draw/plot.h"
#include "ik/goal_motion.h"
#include "scene/clip.h"
#include "tools/cli/report.h"

namespace krok::cli::ik {

struct Outcome {
  const FrameSource& input;
  const std::vector<krok::ik::KeyedGoal>& goals;
  const krok::ik::Limits& limits;
  const krok::ik::GoalMotion& motion;  // its clip for charts alone
};

// One line for display.
std::string summary(const Outcome& outcome);

// A line for each goal.
std::string table(const Outcome& outcome);

// A warning (ik-missed) for each goal that is missed in some frame, with the worst one and the
// joint that holds it back; ik-never for goals that are active in no frame.
Diagnostics missed_goals(const Outcome& outcome);

// A warning (ik-feet) where goals of other limbs move a foot by more than 1 cm.
Diagnostics moved_feet(const Outcome& outcome, std::span<const krok::ik::HeldFoot> legs);

// A warning (ik-range) where goals bring a joint by more than 30 degrees beyond the ranges that
// were measured.
Diagnostics beyond_ranges(const Outcome& outcome);

// A warning (ik-no-feet) where goals take half of a skeleton or more along and nothing is held.
Diagnostics moved_body(const Outcome& outcome);

// Goals, `with_frames` with their residuals in each frame, and the limits.
Json to_json(const Outcome& outcome, bool with_frames);

std::string limits_summary(const krok::ik::Limits& limits);
Json limits_json(const krok::ik::Limits& limits, const Skeleton& skeleton);

// By how much each goal is missed over time, in lengths and in angles, as far as there are such
// goals; the joints whose limits hold a goal back, where any does; and, with limits, by how much
// the joint that is farthest beyond its limits is beyond them, in the input and in the result.
// Lengths are millimetres, angles degrees.
draw::Chart chart_of(const Outcome& outcome, const Clip& given, const std::string& title);

}  // namespace krok::cli::ik
