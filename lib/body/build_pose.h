#pragma once

#include <string>
#include <vector>

#include "body/human_actor.h"
#include "scene/clip.h"

// Which pose a body is built in.

namespace krok::body {

struct BuildPose {
  std::vector<Transform> joint_to_world;
  std::string name;  // for people: "reference", "frame 12, limbs turned aside"
};

// One frame of a clip, joint_to_world.
std::vector<Transform> clip_pose(const Clip& clip, int frame);

// The reference pose, standing upright with its limbs apart (see human_pose.h); made from a frame
// of the clip instead where the reference pose needs so much turning that the twist of the limbs
// would be arbitrary.
BuildPose human_build_pose(const Clip& clip, const HumanActor& actor);

// The reference pose, or the frame of the clip that spreads the bones the most if the reference
// pose folds them on top of each other.
BuildPose general_build_pose(const Clip& clip);

}  // namespace krok::body
