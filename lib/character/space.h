#pragma once

#include <span>
#include <string>

#include "capture/convention_choice.h"
#include "character/rig.h"
#include "core/result.h"
#include "roles/roles.h"

// The unit and axes of a scene.

namespace krok::character {

// The scene's own rotation to Krok's axes where that is not one by whole quarter turns, which
// Conventions cannot tell; otherwise the identity.
Mat4 rotation_to_apply(const nodes::Space& space);

// What the user gave, then what the file says (nodes::Space), then what the figure shows (see
// detect_conventions). `rig` may be null, where a scene has no skeleton: then what is not known is
// a default. `roles` are those of its joints. `samples` are joint positions of frames, [frames x
// joints], in the rig's frame.
Conventions find_conventions(const nodes::Space& space, const Rig* rig, const RoleMap& roles,
                             std::span<const Vec3> samples, const GivenConventions& given);

// Warns of a figure in Krok's frame that is far from a person's size (code scene-unit); figures
// that are not humanoid pass. For scenes whose unit was not detected, but said by the file or the
// user.
void check_size(const Skeleton& skeleton, const RoleMap& roles, Diagnostics& diagnostics);

// Holds a skeleton in Krok's frame against what a figure should be: upright, facing +Z. What is
// otherwise is warned of with the option that mends it (codes scene-up, scene-forward); figures
// that are not humanoid pass. For scenes whose axes were not detected, but said by the file or the
// user.
void check_actor(const Skeleton& skeleton, const RoleMap& roles, Diagnostics& diagnostics);

}  // namespace krok::character
