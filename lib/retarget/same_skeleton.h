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
  std::vector<int> source_joint;  // [target joints]; -1, by same_person() alone: only the target's
};

// Whether a joint is another one or above it.
bool carries(const Skeleton& skeleton, int joint, int carried);

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

// The same of two humanoids of which either has joints that the other lacks: a root above the hips,
// cameras, props, fingers. All the target's joints with a role of a single joint are in the source
// by the same name, below the same parent (the hips, and what carries them, below any). Offsets
// agree within 0.5 % of the mean bone; those of spine, collars and thighs, which some rigs (Biped)
// move in their parents, of fingers and of joints without a role may be off by a third of the bone.
// Below the hips no reference rotation is turned by more than 75 degrees about a bone against the
// other's, but for one forearm. Where names and parents are all the same, roles may differ, as
// those found by a pose that the file happens to show. Empty if not, and where the user gave roles.
std::optional<SameSkeleton> same_person(const Skeleton& source, const RoleMap& source_roles,
                                        const Skeleton& target, const RoleMap& target_roles);

}  // namespace krok::retarget
