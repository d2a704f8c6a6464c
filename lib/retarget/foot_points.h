#pragma once

#include <span>
#include <vector>

#include "contacts/sole_points.h"
#include "math/transform.h"
#include "roles/roles.h"
#include "scene/model.h"

// The points of feet that come first to the ground, beside their joints.

namespace krok::retarget {

// A point fixed to a joint.
struct BodyPoint {
  int joint = -1;
  Vec3 offset = Vec3::Zero();  // metres, in the joint's frame

  Vec3 in(std::span<const Transform> pose) const {
    return pose[static_cast<std::size_t>(joint)] * offset;
  }
};

// The outline of a mesh's feet seen from the side, on their middle lines: of the vertices that
// follow a foot or a joint below it by more than half, those that are lowest as the foot pitches by
// up to 90 degrees, at most 13 a joint. Empty without such vertices, or where the roles know no
// feet. `skeleton` is with_limb_ends() of the model, or the model's own; a foot that hangs
// elsewhere is the limb's.
std::vector<BodyPoint> points_of_feet(const Model& model, const Skeleton& skeleton,
                                      const RoleMap& roles);

// The tips of the toes that find_feet() estimated, for want of an end site.
std::vector<BodyPoint> estimated_tips(const krok::Feet& feet);

}  // namespace krok::retarget
