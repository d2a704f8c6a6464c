#pragma once

#include <span>

#include "body/implicit.h"
#include "scene/skeleton.h"

namespace krok::body {

// A body around any skeleton. Every bone is a tube; how thick it is follows from the length of all
// bones that hang on it, as the branches of a tree: cross-sections (squared radii) grow in
// proportion to it, so a spine is thicker than the legs and everything tapers to its tips. Chains
// of bones run on as one tube through their joints, the rest is blended on where it branches off.
// Bones of no length are passed over; a skeleton without any length becomes a ball of `lone_radius`
// metres.
Shape general_shape(const Skeleton& skeleton, std::span<const Transform> pose,
                    double lone_radius = 0.1);

}  // namespace krok::body
