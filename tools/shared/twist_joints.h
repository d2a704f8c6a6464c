#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "scene/model.h"
#include "tools/cli/command_options.h"

namespace krok::cli {

// The kinds of bones of --twist-joints, and how many joints each gets.
struct TwistJoints {
  struct Bones {
    std::string name;  // upper_arm, forearm, thigh or shin
    int count = 1;
  };
  std::vector<Bones> bones;  // each once; none: no twist joints
};

// --twist-joints LIST.
void add_twist_joints_option(CommandOptions& command, TwistJoints& twist);

// Adds them to both sides of a model whose joints' roles are found by their names. An Error (code
// twist-joints) for a bone that neither side has, and those of krok::add_twist_joints().
Status add_twist_joints(const TwistJoints& twist, Model& model);

}  // namespace krok::cli
