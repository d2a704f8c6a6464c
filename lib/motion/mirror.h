#pragma once

#include <cstdint>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"

// Mirrors a motion: exchanges left and right.

namespace krok {

struct MirrorPairs {
  static constexpr int kNone = -1;
  // For each joint its counterpart on the other side: itself for joints of the middle, kNone if
  // none was found. An involution where it is not kNone. The root is its own.
  std::vector<int> partners;
  // [joints], 1 for joints that are a known part of the body; empty: all are. See mirror().
  std::vector<std::uint8_t> in_body;
  double plane = 0;  // the plane of symmetry in the reference pose is x = `plane`

  std::vector<int> unpaired() const;
};

// Pairs the joints: by roles, where each side has one joint of a role; then by names that differ in
// left and right; then, below paired joints, by position in the reference pose. Names on both sides
// need not be alike. Never fails.
MirrorPairs find_mirror_pairs(const Skeleton& skeleton, const RoleMap& roles);

// Mirrors the motion at the world plane x = 0: the left arm does what the right one did, and a path
// to the left goes to the right. Mirroring twice restores the motion up to float rounding.
//
// Each joint's world rotation from the reference pose is mirrored, so joint axes need not be alike
// on both sides. Where bones of the reference pose are not mirror images of each other, the
// difference is compensated, so that the bones of the result are. Bone lengths are kept. Joints
// without a counterpart keep their transforms relative to their parents. So do joints that are not
// part of the body (jaws, eyes, tongues), do not move relative to their parents, and would be
// turned by over 60 degrees: some exporters' reference poses have them twisted, so that a constant
// offset this large is not part of the pose.
Clip mirror(const Clip& clip, const MirrorPairs& pairs);

}  // namespace krok
