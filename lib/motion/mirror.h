#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

// Mirrors a motion: exchanges left and right.

namespace krok {

struct MirrorPairs {
  static constexpr int kNone = -1;
  // For each joint its counterpart on the other side: itself for joints of the middle, kNone if
  // none was found. An involution where it is not kNone. The root is its own.
  std::vector<int> partners;
  // [joints], 1 for joints that are a known part of the body; empty: all are. See mirror().
  std::vector<std::uint8_t> in_body;
  // The character's plane of symmetry in the reference pose, across.dot(place) = plane: x, unless
  // the pose faces aside.
  Vec3 across = Vec3::UnitX();
  double plane = 0;
  int carrier = 0;  // what carrying_joint() gives

  std::vector<int> unpaired() const;
};

// Pairs the joints: by roles, where each side has one joint of a role; then by names that differ in
// left and right; then, below paired joints, by position in the reference pose. Names on both sides
// need not be alike. Never fails.
MirrorPairs find_mirror_pairs(const Skeleton& skeleton, const RoleMap& roles);

// Mirrors the motion at the world plane x = 0: the left arm does what the right one did, and a path
// to the left goes to the right. Mirroring twice restores the motion up to float rounding.
//
// Every joint comes exactly where its partner's image is, whatever the reference pose and the
// joints' own axes are. The character is mirrored with the motion: where bones differ between the
// sides, each takes the length of its partner's, in the skeleton of the result too. Joints without
// a partner go along with their parents, their transforms relative to them unchanged.
//
// Orientations are the images of the partners', turned by axes_to_images(). Joints that are no part
// of the body (jaws, eyes, tongues), do not move in their parents, and would be turned by over 60
// degrees keep their rotations relative to their parents: some exporters' reference poses have them
// twisted, and what stays that far off is no posture. Joints above the hips that stand, or keep to
// the hips' ground frame, are not turned.
//
// `posture` is that of axes_to_images(), by default the clip's usual_pose() (frame_source.h). Clips
// of one actor that are blended need the same.
Clip mirror(const Clip& clip, const MirrorPairs& pairs, std::span<const Transform> posture = {});

// The same of frames generated on demand. They are read once beforehand, on `jobs` threads, where
// joints have to be watched over the whole motion. Errors are those of the source.
Result<FrameSource> mirror(const FrameSource& source, const MirrorPairs& pairs, int jobs,
                           std::span<const Transform> posture = {});

// For each joint the turn from the image of its partner's axes to its own, [joints]; the identity
// without a partner. The bones that hang on both tell it: a vector v in the partner's axes has the
// image turn.conjugate() * (-v.x, v.y, v.z) in the joint's. Only what they leave open, the twist
// about a single bone or about bones that lie within a hundredth of one line, is taken from the
// reference pose. `posture` (joint_to_world, the usual one; may be empty) corrects the reference
// pose: bones that it has in another direction count as they are there; joints of the middle take
// the axes of a joint next to them, and joints next to the trunk those a quarter or half round
// about their bone, rather than be turned by far in their parents. Necks and heads may look aside
// all the time, by up to half a right angle and a little more.
std::vector<Quat> axes_to_images(const Skeleton& skeleton, const MirrorPairs& pairs,
                                 std::span<const Transform> posture = {});

}  // namespace krok
