#pragma once

#include <span>

#include "capture/convention_choice.h"
#include "character/rig.h"
#include "core/result.h"
#include "roles/roles.h"

// The unit and axes of a scene.

namespace krok::character {

// The scene's rotation to Krok's axes if it is not a multiple of 90 degrees, which Conventions
// cannot represent; otherwise the identity.
Mat4 rotation_to_apply(const nodes::Space& space);

// Conventions in order of precedence: given by the user, specified by the file (nodes::Space),
// detected from the character (see detect_conventions). `rig` may be null for a scene without a
// skeleton: then what is unknown is a default. `roles` are those of its joints. `samples` are joint
// positions of frames, [frames x joints], in the rig's frame.
Conventions find_conventions(const nodes::Space& space, const Rig* rig, const RoleMap& roles,
                             std::span<const Vec3> samples, const GivenConventions& given);

// Whether a person, a doll or a giant could be so large, in metres.
bool is_plausible_size(double size);

// Warns if a humanoid in Krok's frame is far from human size, or anything else larger than animals
// are (code scene-unit). For scenes whose unit was not detected but given by the file or the user.
void check_size(const Skeleton& skeleton, const RoleMap& roles, Diagnostics& diagnostics);

// Warns if a humanoid in Krok's frame is not upright or does not face +Z, with the option that
// corrects it (codes scene-up, scene-forward). For scenes whose axes were not detected but given by
// the file or the user.
void check_actor(const Skeleton& skeleton, const RoleMap& roles, Diagnostics& diagnostics);

}  // namespace krok::character
