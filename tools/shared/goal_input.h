#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include "ik/goal_motion.h"
#include "roles/roles.h"
#include "scene/character.h"
#include "tools/cli/tool.h"

// Goal files, for the tools that read them.

namespace krok::cli {

// A goal file (formats/goals), with the motions that its goals are relative to.
struct OpenedGoals {
  std::vector<krok::ik::KeyedGoal> goals;
  std::vector<double> stiffness;  // [joints], or empty
  bool root_moves = false;
  std::deque<Clip> motions;  // goals point to these
};

// Codes: those of goals::read() and of reading motions; goals-joint for a joint that another motion
// has not.
Result<OpenedGoals> open_goals(const std::string& path, const Skeleton& skeleton,
                               const RoleMap& roles, ToolContext& context,
                               std::span<const Character::Socket> sockets = {});

}  // namespace krok::cli
