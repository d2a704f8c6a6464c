#pragma once

#include <span>

#include "core/result.h"
#include "scene/clip.h"

// Moving, turning and scaling a whole motion. The functions that work out a movement give a
// transform of the world, so that several can be put together; move_clip applies it. `carrier` is
// what carrying_joint() gives; clips without frames give the identity.

namespace krok {

// Moves every joint of every frame; the reference pose stays.
void move_clip(const Transform& world_to_world, Clip& clip);

// The figure stands over the origin in the first frame; height and facing stay.
Transform to_origin(const Clip& clip, int carrier);

// The figure is turned by `angle` radians about the vertical through its place in the first frame.
Transform turned_about_start(const Clip& clip, int carrier, double angle);

// The same, so that it faces `heading` in the first frame.
Transform facing_at_start(const Clip& clip, int carrier, double heading);

// The lowest place that one of `joints` has in any frame comes to y = 0.
Transform onto_ground(const Clip& clip, std::span<const int> joints);

// Figure and motion by a factor, about the origin: positions of all frames and of the reference
// pose. Code motion-scale unless the factor is positive and finite.
Status scale_clip(double factor, Clip& clip);

// Metres from the lowest joint to the highest in the reference pose.
double reference_height(const Skeleton& skeleton);

}  // namespace krok
