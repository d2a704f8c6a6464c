#pragma once

#include "math/types.h"

namespace krok::render {

// An orthographic camera: equal lengths are equally long in the picture wherever they are, so that
// they can be read off it. It looks at `target` from the direction that is turned by `yaw` about
// +Y (0 is +Z, what a figure in its reference pose faces; a quarter turn is +X, its left) and
// raised by `elevation` (-pi/2 .. pi/2; pi/2 looks straight down). Up in the picture is up in the
// world, looking straight down it is away from the direction of `yaw`.
struct Camera {
  Vec3 target = Vec3::Zero();     // world, metres
  double yaw = 0, elevation = 0;  // radians
  double pixels_per_metre = 100;  // > 0
  Vec2 place_of_target = {0, 0};  // pixels, x to the right and y down

  // Unit vectors in the world: to the right and up in the picture, and towards the camera.
  Vec3 right() const;
  Vec3 up() const;
  Vec3 towards() const;

  // Where a point of the world is in the picture, pixels.
  Vec2 project(const Vec3& point) const;
};

}  // namespace krok::render
