#pragma once

#include <vector>

#include "ragdoll/bodies.h"
#include "scene/clip.h"

namespace krok::ragdoll {

// Of a point in the body's frame to the surface, metres; negative inside.
double signed_distance(const Shape& shape, const Vec3& point);

// A stretch in which two bodies are in each other.
struct Overlap {
  int first = 0, second = 0;            // bodies
  int first_frame = 0, last_frame = 0;  // inclusive
  int worst = 0;                        // frame
  double depth = 0;                     // metres there, beyond that in the reference pose
};

// Where bodies that hang neither from each other nor from the same body are in each other, over
// `limit` metres deeper than in the reference pose. The depth is how far the one must be moved out
// along the nearest surface of the other: of the core of a shape (a box has a segment along its
// longest side, with its smallest extent for a radius) in the other shape.
// Stretches of a pair that are less than 0.25 s apart are one. By pair, then by frame.
std::vector<Overlap> find_overlaps(const Clip& clip, const std::vector<Body>& bodies, double limit);

}  // namespace krok::ragdoll
