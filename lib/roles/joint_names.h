#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/skeleton.h"

// What a joint's name says, whatever the exporter: the part of the body and the side. Names alone;
// find_roles holds them against the structure.

namespace krok {

enum class Side : unsigned char { middle, left, right };

// The word in a name. Some words mean another joint from one exporter to the next ("shoulder" is
// the collar bone in MotionBuilder and the upper arm in iPi and Biovision), so they are kept apart
// here.
enum class Part : unsigned char {
  unknown,
  hips,
  spine,
  neck,
  head,
  collar,
  shoulder,  // collar or upper arm
  upper_arm,
  arm,  // upper arm, or lower arm beside a named upper arm
  lower_arm,
  hand,
  hip,  // the hip of one side: the upper leg, unless a joint is named so
  upper_leg,
  leg,  // lower leg, or upper leg beside a named lower leg
  lower_leg,
  foot,
  toes,
  helper  // twist joints, face, props, targets of inverse kinematics
};

struct JointName {
  Part part = Part::unknown;
  Side side = Side::middle;
};

// The words of all joints' names, shape [joints]. Name spaces ("mixamorig:") and words that most of
// the names begin with ("Bip01", "CC_Base_", "Robot_") are left out. End sites are unknown.
std::vector<JointName> read_joint_names(const Skeleton& skeleton);

// The words and numbers of a name in lower case: "mixamorig:LeftForeArm2" is left, fore, arm, 2.
std::vector<std::string> name_tokens(std::string_view name);

}  // namespace krok
