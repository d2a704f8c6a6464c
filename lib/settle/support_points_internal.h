#pragma once

#include <optional>
#include <vector>

#include "ragdoll/bodies.h"
#include "terrain/terrain.h"

// What of a body can touch the ground, as small spheres.

namespace krok::settling {

struct SupportPoint {
  int body = 0;
  Vec3 centre = Vec3::Zero();  // metres, in the frame of the body's joint
  double radius = 0;
};

// Of each body, in order: along capsules and over the sides of boxes; with a model its vertices
// that are outermost in 80 directions.
std::vector<SupportPoint> support_points(const std::vector<ragdoll::Body>& bodies,
                                         const Model* model);

// The ground at a place (world): the highest surface up to a step above it, or else the highest.
std::optional<GroundPoint> surface_at(const Terrain& ground, const Vec3& place);

// How far a sphere (world) is above the ground, metres, negative if it is in it; infinite where
// there is no ground.
double clearance(const Terrain& ground, const Vec3& centre, double radius);

}  // namespace krok::settling
