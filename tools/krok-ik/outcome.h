#pragma once

#include <string>
#include <vector>

#include "ik/goal_motion.h"
#include "tools/common/report.h"

namespace krok::ik_tool {

struct Outcome {
  const Clip& input;
  const std::vector<ik::KeyedGoal>& goals;
  const ik::Limits& limits;
  const ik::GoalMotion& motion;
};

// One line for display.
std::string summary(const Outcome& outcome);

// A line for each goal.
std::string table(const Outcome& outcome);

// A warning (ik-missed) for each goal that is missed in some frame, with the worst one and the
// joint that holds it back; ik-never for goals that are active in no frame.
Diagnostics missed_goals(const Outcome& outcome);

// Goals with their residuals in each frame, and the limits.
Json to_json(const Outcome& outcome);

std::string limits_summary(const ik::Limits& limits);
Json limits_json(const ik::Limits& limits, const Skeleton& skeleton);

}  // namespace krok::ik_tool
