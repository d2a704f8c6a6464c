#pragma once

#include <string>
#include <vector>

#include "body/human_actor.h"
#include "scene/clip.h"

// Selects the pose that a body is built in.

namespace krok::body {

struct BuildPose {
  std::vector<Transform> joint_to_world;
  std::string name;  // for display: "reference", "frame 12, limbs turned aside"
};

// One frame of a clip, joint_to_world.
std::vector<Transform> clip_pose(const Clip& clip, int frame);

// The reference pose, standing upright with limbs apart (see human_pose.h); a T-pose built from the
// skeleton (retarget::neutral_skeleton) if the reference pose needs so much rotation that the twist
// of the limbs would be arbitrary.
BuildPose human_build_pose(const Clip& clip, const RoleMap& roles, const HumanActor& actor);

// The reference pose or, if that folds bones onto each other, the frame of the clip with the
// largest spread of bones.
BuildPose general_build_pose(const Clip& clip);

}  // namespace krok::body
