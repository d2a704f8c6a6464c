#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "motion/local_motion.h"
#include "ragdoll/bodies.h"
#include "scene/skeleton.h"

namespace krok::ragdoll {

// The height of the ground at (x, z), metres; nothing where there is none.
using GroundHeight = std::function<std::optional<double>(double x, double z)>;

// How deep a body is in the ground in a pose (joint_to_world, shape [joints]), metres; negative
// above it, by the corners of boxes and the lowest points of round shapes.
double depth_in_ground(const Body& body, std::span<const Transform> pose,
                       const GroundHeight& ground);

// The deepest body of a pose.
double depth_in_ground(const std::vector<Body>& bodies, std::span<const Transform> pose,
                       const GroundHeight& ground);

// Lifts bodies out of the ground from frame `begin` on: moves the root up and turns other bodies
// about their joints, smoothed over time (a Gaussian of `smoothing` seconds) against jerks; what
// that leaves deeper than 3 mm lifts the whole body. The correction fades in over the first frames
// from `begin`. A motion with nothing deeper than 3 mm stays as it is. `rate` is frames per second.
// The root is the joint that carries the body, as of clips rooted at the hips (HipsRoot).
void clear_ground(const Skeleton& skeleton, const std::vector<Body>& bodies,
                  const GroundHeight& ground, int begin, double rate, double smoothing,
                  LocalMotion& motion);

}  // namespace krok::ragdoll
