#pragma once

#include <optional>
#include <vector>

#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok::retarget {

// Two skeletons with the same bones, in any reference poses.
struct SameSkeleton {
  double scale = 1;               // lengths of the target over those of the source; exactly 1 if
                                  // equal within a millionth
  std::vector<int> source_joint;  // [target joints]
};

// Whether the target is the source, uniformly scaled: the same names, the same parents, and each
// joint at the same offset from its parent within a thousandth of a per cent of the skeleton. Empty
// if not. Skeletons of one joint, or of bones of zero length, are the same at scale 1.
// The joints may be in any order.
std::optional<SameSkeleton> same_skeleton(const Skeleton& source, const Skeleton& target);

// The same of two humanoids whose joints have other names: joints in the same order, with the same
// parents, offsets and reference rotations (bones along one axis do not show the turn about it),
// and no role that is another joint's. Empty if either is not a humanoid.
std::optional<SameSkeleton> same_body(const Skeleton& source, const RoleMap& source_roles,
                                      const Skeleton& target, const RoleMap& target_roles);

}  // namespace krok::retarget
