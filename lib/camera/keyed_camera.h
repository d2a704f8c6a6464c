#pragma once

#include <optional>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/camera_track.h"

// A camera animated by keys at arbitrary times.

namespace krok {

// Interpolation from one key to the next.
enum class Between : unsigned char {
  smooth,  // cubic Hermite using the neighbouring keys, squad for orientations
  linear,  // constant speed
  ease,    // at rest at both ends: smoothstep, 3t^2 - 2t^3
  step     // holds the key's value until the next key
};

struct CameraKey {
  double time = 0;               // seconds, from 0
  Vec3 position = Vec3::Zero();  // metres
  // Exactly one of these: the point it looks at, or its orientation (camera_to_world, unit).
  std::optional<Vec3> target;
  std::optional<Quat> orientation;
  double roll = 0;                      // radians, to the right; applied after the orientation
  std::optional<double> field_of_view;  // vertical, radians, in (0, pi)
  Between between = Between::smooth;    // from this key to the next
  double tension = 0;                   // 0: Catmull-Rom; 1: comes to rest at the key
};

struct KeyedCamera {
  std::vector<CameraKey> keys;  // times increase strictly
  // The last key equals the first, and the camera moves through it without a stop.
  bool closed = false;
};

inline constexpr double kUsualFieldOfView = 45 * kRadiansPerDegree;

// Frames at `rate` from time 0 to the last key; if that falls between two frames, one more frame
// holds it. Before the first key, the first key holds.
//
// Consecutive `smooth` keys form a curve that passes through them with continuous velocity:
// positions, targets and rolls by Hermite cubics with tension_velocities() from lib/math,
// orientations by squad, fields of view by monotone cubics, so that they do not overshoot. The
// curve ends where another interpolation begins.
//
// If all keys have targets, the camera looks at the interpolated target, with world up (for views
// straight up or down, see look_at.h). If any key has an orientation instead, the orientations at
// the keys are interpolated. A key without a field of view is ignored in interpolating it; if no
// key has one, it is 45 degrees. A step holds the field of view, too, and ends in a cut of the
// track.
//
// Codes: camera-keys (no keys; times that do not increase, are negative or not finite; a key with
// neither or both of target and orientation, a target at the camera's position; values that are not
// finite or out of range; a closed camera whose keys are not all smooth), camera-rate,
// camera-too-long (more than 10 million frames).
Result<CameraTrack> make_track(const KeyedCamera& camera, double rate);

}  // namespace krok
