#pragma once

#include <span>

#include "body/implicit.h"
#include "scene/skeleton.h"

namespace krok::body {

// A body around any skeleton. Every bone is a tube whose cross-section (squared radius) is
// proportional to the total length of all descendant bones, as in the branches of a tree, so a
// spine is thicker than the legs and limbs taper to their tips. A chain of bones is one tube
// through its joints; other bones are blended on where they branch off. Zero-length bones are
// skipped, and those that stand for no part of a body: to IK targets, props, eyes and other parts
// of a face, by name, and from a root on the ground to the body above it. A skeleton of zero extent
// becomes a ball of radius `lone_radius` metres.
Shape general_shape(const Skeleton& skeleton, std::span<const Transform> pose,
                    double lone_radius = 0.1);

}  // namespace krok::body
