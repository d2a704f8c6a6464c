#pragma once

#include "math/transform.h"

namespace krok::render {

// An orthographic camera, so that lengths can be measured in the image. It looks at `target` from
// the direction given by `yaw` about +Y (0 is +Z, the facing of a character in its reference pose;
// pi/2 is +X, its left) and `elevation` (-pi/2 .. pi/2; pi/2 looks straight down). Image up is
// world up; looking straight down, it points away from the direction of `yaw`.
struct Camera {
  Vec3 target = Vec3::Zero();     // world, metres
  double yaw = 0, elevation = 0;  // radians
  double pixels_per_metre = 100;  // > 0
  Vec2 place_of_target = {0, 0};  // pixels, x to the right and y down

  // World-space unit vectors: image right, image up, and towards the camera.
  Vec3 right() const;
  Vec3 up() const;
  Vec3 towards() const;

  // Projects a world point to image pixels.
  Vec2 project(const Vec3& point) const;
};

// A perspective camera. As in CameraTrack it looks along its local -Z with +Y up.
struct Lens {
  Vec3 eye = Vec3::Zero();                  // world, metres
  Quat camera_to_world = Quat::Identity();  // unit
  double field_of_view = kPi / 4;           // vertical, radians, in (0, pi)
};

}  // namespace krok::render
