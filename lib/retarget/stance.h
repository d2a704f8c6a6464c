#pragma once

#include <optional>
#include <vector>

#include "core/result.h"
#include "retarget/pose_alignment.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok::retarget {

// The pose that rotations are measured from.
struct Stance {
  std::vector<Transform> pose;  // joint_to_world, shape [joints]
  std::optional<int> frame;     // of the motion; empty for the skeleton's reference pose
};

// Whether a humanoid stands in a pose: trunk, thighs and shanks within 60 degrees of upright, and
// neither thighs nor the bends of the knees differ by over 15 degrees, as in a step. In reference
// poses of exporters whose bones all lie along one axis it does not.
bool stands(const Actor& actor);

// Whether trunk, thighs and shanks of a humanoid lie within 60 degrees of one line, whichever way.
bool is_straight(const Actor& actor);

// The reference pose of a clip's skeleton. If that does not stand, it is turned upright where
// trunk, thighs and shanks lie within 60 degrees of one line and it is no step; else a T-pose is
// built from the skeleton, its trunk upright, in which the turn about the limbs is that with which
// knees and elbows bend as they do over the whole motion. All motions of a skeleton so have the
// same, to a few degrees. `frame` selects a frame's pose directly; an Error (code retarget-frame)
// if there is no such frame. Skeletons that are not humanoids keep their reference pose.
Result<Stance> find_stance(const Clip& clip, const RoleMap& roles, std::optional<int> frame);
Result<Stance> stance_of_frame(const FrameSource& source, int frame);

// A clip's skeleton with a reference pose that angles of an anatomy can be measured from and bodies
// built in: its own where trunk, thighs and shanks lie within 60 degrees of one line, whichever way
// it lies, and for skeletons that are not humanoids; else that of find_stance().
Skeleton neutral_skeleton(const Clip& clip, const RoleMap& roles);
// The same of frames that are produced on demand.
Result<Skeleton> neutral_skeleton(const FrameSource& source, const RoleMap& roles);

// Whether a humanoid's reference pose is upright but not the same on both sides, by over 20 degrees
// of a bone of the limbs: no T- or A-pose but a frame of a motion, as files without a mesh have.
bool is_frame_of_motion(const Skeleton& skeleton, const RoleMap& roles);

// A T-pose for a clip whose reference pose is such a frame, shape [joints]: facing +Z, with the
// frame's bones, hips and ground.
std::vector<Transform> stance_from_frame(const Clip& clip, const RoleMap& roles);

// The frames of a motion, at most 2000, that find_stance() and neutral_skeleton() look at: they
// give the same for these. Errors are those of the source.
Result<Clip> frames_looked_at(const FrameSource& source);

}  // namespace krok::retarget
