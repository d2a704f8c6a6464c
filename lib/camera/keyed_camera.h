#pragma once

#include <optional>
#include <vector>

#include "core/result.h"
#include "math/types.h"
#include "scene/camera_track.h"

// A camera through keys at times of their own.

namespace krok {

// How it gets from one key to the next.
enum class Between : unsigned char {
  smooth,  // with the keys beside them: cubic Hermite, squad for orientations
  linear,  // straight and evenly
  ease,    // straight, at rest at both ends: the part 3t^2 - 2t^3 of the way
  step     // stays until the next key
};

struct CameraKey {
  double time = 0;               // seconds, from 0
  Vec3 position = Vec3::Zero();  // metres
  // One of these: what it looks at, or its orientation (camera_to_world, unit).
  std::optional<Vec3> target;
  std::optional<Quat> orientation;
  double roll = 0;                      // radians, to the right; on top of the orientation
  std::optional<double> field_of_view;  // vertical, radians, in (0, pi)
  Between between = Between::smooth;    // from this key to the next
  double tension = 0;                   // 0: Catmull-Rom, to 1: comes to rest at the key
};

struct KeyedCamera {
  std::vector<CameraKey> keys;  // times rise strictly
  // The last key is the first again, and the movement goes on through it.
  bool closed = false;
};

inline constexpr double kUsualFieldOfView = 45 * kRadiansPerDegree;

// Frames at `rate` from time 0 to the last key; where that falls between two frames, one more frame
// holds it. Before the first key the first holds.
//
// Keys joined by `smooth` one after the other make a curve that passes through them with continuous
// velocity: positions, targets and rolls by Hermite cubics whose velocities are
// tension_velocities() of lib/math, orientations by squad, fields of view by monotone cubics, so
// that no lens goes beyond its keys. Where another kind of join begins, a curve ends by itself.
//
// Where all keys have targets the camera looks at the moving target, with the world's up (look_at.h
// says what where it looks straight up or down). If any has an orientation instead, the
// orientations at the keys are interpolated. A key without a field of view takes part in no lens
// curve; without any, 45 degrees.
//
// Codes: camera-keys (none; times that do not rise, are negative or not finite; a key with neither
// or both of target and orientation, a target at the camera's place; values that are not finite or
// out of range; a closed one whose keys are not all smooth), camera-rate, camera-too-long (more
// than 10 million frames).
Result<CameraTrack> make_track(const KeyedCamera& camera, double rate);

}  // namespace krok
