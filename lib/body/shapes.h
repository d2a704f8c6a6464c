#pragma once

#include <span>
#include <string>
#include <vector>

#include "body/human_actor.h"
#include "body/implicit.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/skeleton.h"

namespace krok::body {

// A human body around a skeleton that stands upright on its feet, facing +Z with its left at +X
// (see human_pose.h). `pose` is joint_to_world, [joints].
//
// Proportions: segment lengths and heights over stature after Drillis and Contini (1966) as given
// by Winter; breadths, depths and girths over stature rounded from the means of ANSUR II (Gordon et
// al. 2014, men 1.756 m, women 1.629 m), between the two and slightly leaner. Girths become
// ellipses of that circumference.
Shape human_shape(const Skeleton& skeleton, const HumanActor& actor,
                  std::span<const Transform> pose);

// A body around any skeleton. Every bone is a tube whose cross-section (squared radius) is
// proportional to the total length of all descendant bones, as in the branches of a tree, so a
// spine is thicker than the legs and limbs taper to their tips. A chain of bones is one tube
// through its joints; other bones are blended on where they branch off. Zero-length bones are
// skipped, and those that stand for no part of a body: to IK targets, props, eyes and other parts
// of a face, by name, and from a root on the ground to the body above it. A skeleton of zero extent
// becomes a ball of radius `lone_radius` metres.
Shape general_shape(const Skeleton& skeleton, std::span<const Transform> pose,
                    double lone_radius = 0.1);

// Selects the pose that a body is built in.

struct BuildPose {
  std::vector<Transform> joint_to_world;
  std::string name;  // for display: "reference", "frame 12, limbs turned aside"
};

// One frame of a motion, joint_to_world.
Result<std::vector<Transform>> pose_of(const FrameSource& source, int frame);

// Reference poses that have joints half round about their bones against every frame of the motion
// would wring skins around them all the time: turns such joints of `pose` about their bones to
// where they usually are, where a single bone hangs on them. Errors are those of the source.
Status untwist(const FrameSource& source, std::vector<Transform>& pose);

// Some skeletons end each leg with a point below the ankle, on the ground, which is no tip of a
// foot: it would hang from the shank. Takes such tips, in line with the shank in the motion, out
// of the landmarks. Errors are those of the source.
Status drop_tips_below_ankles(const FrameSource& source, HumanActor& actor);

// The reference pose, standing upright with limbs apart (see human_pose.h); a T-pose built from the
// skeleton (retarget::neutral_skeleton) if the reference pose needs so much rotation that the twist
// of the limbs would be arbitrary.
Result<BuildPose> human_build_pose(const FrameSource& source, const RoleMap& roles,
                                   const HumanActor& actor);

// The reference pose or, if that folds bones onto each other, the frame of the clip with the
// largest spread of bones.
Result<BuildPose> general_build_pose(const FrameSource& source);

}  // namespace krok::body
