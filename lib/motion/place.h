#pragma once

#include <span>

#include "core/result.h"
#include "scene/clip.h"

// Moves, turns and scales a whole motion. Functions that compute a movement return a world_to_world
// transform, so that several can be combined; move_clip applies it. `carrier` is the result of
// carrying_joint(); clips without frames give the identity.

namespace krok {

// Transforms every joint of every frame; the reference pose is unchanged.
void move_clip(const Transform& world_to_world, Clip& clip);

// Moves the character's position in the first frame to the origin; keeps height and heading.
Transform to_origin(const Clip& clip, int carrier);

// Turns by `angle` radians about the vertical through the character's position in the first frame.
Transform turned_about_start(const Clip& clip, int carrier, double angle);

// As above, so that the character faces `heading` (radians) in the first frame.
Transform facing_at_start(const Clip& clip, int carrier, double heading);

// Moves the lowest position of `joints` in any frame to y = 0.
Transform onto_ground(const Clip& clip, std::span<const int> joints);

// Scales the positions of all frames and of the reference pose about the origin. Code motion-scale
// unless the factor is positive and finite and the result fits in floats.
Status scale_clip(double factor, Clip& clip);

// Height from the lowest joint to the highest in the reference pose, metres.
double reference_height(const Skeleton& skeleton);

}  // namespace krok
