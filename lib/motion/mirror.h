#pragma once

#include <cstdint>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"

// Left and right exchanged.

namespace krok {

struct MirrorPairs {
  static constexpr int kNone = -1;
  // For each joint the one on the other side; itself for joints of the middle; kNone where none was
  // found. An involution where it is not kNone. The root is its own.
  std::vector<int> partners;
  // [joints], 1 for those whose part in a body is known; empty: all are. See mirror().
  std::vector<std::uint8_t> in_body;
  double plane = 0;  // the figure's plane of symmetry in the reference pose is x = `plane`

  std::vector<int> unpaired() const;
};

// Which joint is whose mirror image: by roles, where each side has one joint of a role; then by
// names that differ in left and right; then below joints already paired by their places in the
// reference pose. Names on both sides need not be alike. Never fails.
MirrorPairs find_mirror_pairs(const Skeleton& skeleton, const RoleMap& roles);

// The motion as seen in a mirror that stands in the world's plane x = 0: the left arm does what the
// right one did, the way to the left goes to the right. Mirrored twice it is the same again up to
// the rounding of floats.
//
// What is carried over is each joint's turn from the reference pose, as seen from the world, so
// joints' own axes need not be alike on both sides. Where bones of the reference pose are no mirror
// images of each other the difference is taken into account, so that the bones of the result are.
// Bones keep their own lengths. Joints without a partner go along with their parents, their
// transforms relative to them unchanged. So do joints that are no part of the body (jaws, eyes,
// tongues), do not move in their parents, and would be turned by over 60 degrees: some exporters'
// reference poses have them twisted, and what stays that far off is no posture.
Clip mirror(const Clip& clip, const MirrorPairs& pairs);

}  // namespace krok
