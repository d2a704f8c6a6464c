#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "ik/goal_motion.h"
#include "roles/roles.h"
#include "scene/character.h"
#include "scene/skeleton.h"

// Reader for goals of inverse kinematics (JSON, hand-written); see formats/goals/SPEC.md.

namespace krok::goals {

// A goal whose keys are relative to a joint of another motion, which the caller opens.
struct OtherMotion {
  std::size_t goal = 0;  // index into GoalFile::goals
  std::string path;      // relative to the goal file
  std::string joint;     // by name or role
  Location where;        // of the path in the file; without the file's name
};

struct GoalFile {
  std::vector<ik::KeyedGoal> goals;
  std::vector<OtherMotion> others;
  std::vector<double> stiffness;  // [joints], or empty
  bool root_moves = false;
};

// The result is in metres and seconds, with joints of `skeleton` by name or role. Goals for which
// the file gives no depth get default_depth(). Safe for untrusted input. Codes, each with line and
// column: json-syntax, json-limit, goals-structure, goals-value, goals-time (times that do not
// increase), goals-joint (no such joint), goals-path.
// "joint" of a goal may be a socket, whose place is the goal's point unless the file gives one.
Result<GoalFile> read(std::string_view text, const Skeleton& skeleton, const RoleMap& roles,
                      std::span<const Character::Socket> sockets = {});

// The JSON Schema of such files.
std::string schema();

// From a joint up to, but without, the joint that carries the body, or the first that carries a
// leg: what a reach moves unless the user says otherwise, so that hips and feet stay where they
// are. 0 (all) for the carrying joint itself and joints above it.
int default_depth(int joint, const Skeleton& skeleton, const RoleMap& roles);

// The direction in a joint's frame that is ahead of the body in the reference pose (body_frame()).
Vec3 facing_axis(int joint, const Skeleton& skeleton, const RoleMap& roles);

}  // namespace krok::goals
