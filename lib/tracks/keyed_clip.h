#pragma once

#include <vector>

#include "math/hermite.h"
#include "scene/clip.h"

// A motion as keys: each joint has keys at times of its own, and only what changes has more than
// one. All transforms are relative to the parent (the root's to the world), in doubles. Times are
// seconds and rise strictly within a track.

namespace krok {

enum class VectorCurve : unsigned char {
  step,     // the key before holds
  linear,   // straight from key to key
  hermite,  // through the keys with the velocities given, see tension_velocities()
  monotone  // the same with those of monotone_velocities()
};

enum class RotationCurve : unsigned char {
  step,   // the key before holds
  slerp,  // along the shorter arc at an even pace
  nlerp,  // along the same arc, normalised linear interpolation
  squad   // through the keys with the angular velocities given, see squad_velocities()
};

// Keys of a position (metres) or a scale (a factor an axis). No key: the track is not there.
struct VectorTrack {
  VectorCurve curve = VectorCurve::linear;
  std::vector<double> times;     // [keys]
  std::vector<Vec3> values;      // [keys]
  std::vector<Vec3> velocities;  // [keys] for hermite and monotone, otherwise none
};

// Keys of a rotation, unit quaternions of either sign.
struct RotationTrack {
  RotationCurve curve = RotationCurve::slerp;
  std::vector<double> times;     // [keys]
  std::vector<Quat> values;      // [keys]
  std::vector<Vec3> velocities;  // [keys] for squad: radians a second in the key's own frame
};

struct KeyedJoint {
  VectorTrack position;    // without keys the reference pose's
  RotationTrack rotation;  // without keys the reference pose's
  VectorTrack scale;       // without keys 1
};

struct KeyedClip {
  Skeleton skeleton;
  double duration = 0;             // seconds, >= 0; keys lie within
  std::vector<KeyedJoint> joints;  // [joints]
  Provenance provenance;

  // Of all tracks together.
  std::size_t key_count() const;
};

// Sets the curve and the velocities that it needs from the keys: for hermite and squad with the
// tension (0 for the smoothest, 1 rests at each key). Closed: the last key is the first again, and
// looped the motion goes through it smoothly.
void set_curve(VectorTrack& track, VectorCurve curve, double tension = 0, Ends ends = Ends::open);
void set_curve(RotationTrack& track, RotationCurve curve, double tension = 0,
               Ends ends = Ends::open);

// Whether what the comments promise holds: check(skeleton), a KeyedJoint for each joint, tracks of
// one length, finite values, times that rise strictly within [0, duration], unit rotations (within
// 1e-3), a finite duration >= 0. Codes: those of check(Skeleton), keyed-shape, keyed-time,
// keyed-value.
Status check(const KeyedClip& clip);

// One key a frame, linear and slerp: nothing is lost. Rotations of a track lie each in the
// hemisphere of the one before.
KeyedClip keyed_clip(const Clip& clip);

// The motion sampled at i / rate, as many frames as frames_within() says, whose codes it has. A
// scale moves what is below its joint and turns nothing (a Clip's joints have none themselves). A
// clip without keys gives no frames.
Result<Clip> uniform_clip(const KeyedClip& clip, double rate);

}  // namespace krok
