#pragma once

#include <vector>

#include "ik/limits.h"
#include "ragdoll/bodies.h"
#include "scene/skeleton.h"

// Bodies and ranges for skeletons that are no humanoids: animals, robots, hands, plants. Metres,
// kilograms.

namespace krok::ragdoll {

// The largest distance between two joints in the reference pose along an axis: how large the
// skeleton is.
double extent(const Skeleton& skeleton);

// A capsule for each bone, from its joint to the joint below; where the skeleton forks, to the
// middle of the joints below, or to the farthest one if they surround it; at a leaf on from the
// bone above, half as long. Radii are 0.2 of the length, at least 0.012 and at most 0.08 of the
// extent. Joints whose bones are under 0.03 of the extent have no body and follow the joint above.
// All bodies are of `root` or below it. Masses are not set. Empty if the skeleton has no extent.
std::vector<Body> bone_bodies(const Skeleton& skeleton, int root);

// Cones about the reference pose for joints with a body: they swing by 50 degrees and twist by 30
// about the body's own axis. All others are free.
ik::Limits cone_limits(const Skeleton& skeleton, const std::vector<Body>& bodies);

}  // namespace krok::ragdoll
