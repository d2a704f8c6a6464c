#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/skeleton.h"

// Reads body part and side from joint names of any exporter. Uses names only; find_roles checks
// them against the hierarchy.

namespace krok {

enum class Side : unsigned char { middle, left, right };

// The body part word in a name. The meaning of some words depends on the exporter ("shoulder" is
// the collar bone in MotionBuilder and the upper arm in iPi and Biovision), so they are kept
// separate.
enum class Part : unsigned char {
  unknown,
  hips,
  spine,
  neck,
  head,
  collar,
  shoulder,  // collar or upper arm
  upper_arm,
  arm,  // upper arm, or lower arm if another joint is named upper arm
  lower_arm,
  hand,
  hip,  // hip of one side: the upper leg, unless another joint is named upper leg
  upper_leg,
  leg,  // lower leg, or upper leg if another joint is named lower leg
  lower_leg,
  foot,
  toes,
  helper  // twist joints, face, props, IK targets
};

struct JointName {
  Part part = Part::unknown;
  Side side = Side::middle;
};

// Part and side of all joints, shape [joints]. Ignores namespaces ("mixamorig:") and words that
// most names start or end with ("Bip01", "CC_Base_", "Robot_"). End sites are unknown.
std::vector<JointName> read_joint_names(const Skeleton& skeleton);

// Whether a name is that of a joint that stands for no part of a body's shape: an IK target, a
// control, a prop, an eye or another part of a face.
bool names_no_shape(std::string_view name);

// The words and numbers of a name in lower case, without namespace: "mixamorig:LeftForeArm2" gives
// left, fore, arm, 2.
std::vector<std::string> name_tokens(std::string_view name);

}  // namespace krok
