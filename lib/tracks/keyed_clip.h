#pragma once

#include <vector>

#include "core/result.h"
#include "math/hermite.h"
#include "scene/clip.h"

// A keyframed motion: each track has its own key times, and only what changes has more than one
// key. All transforms are relative to the parent (the root's to the world), in double precision.
// Times are seconds and strictly increasing within a track.

namespace krok {

enum class VectorCurve : unsigned char {
  step,     // holds the previous key
  linear,   // linear interpolation
  hermite,  // Hermite spline with the track's velocities, see tension_velocities()
  monotone  // same, velocities from monotone_velocities()
};

enum class RotationCurve : unsigned char {
  step,   // holds the previous key
  slerp,  // shorter arc at constant speed
  nlerp,  // same arc, normalised linear interpolation
  squad   // spline with the track's angular velocities, see squad_velocities()
};

// Keys of a position (metres) or a scale (one factor per axis). Without keys the track is absent.
struct VectorTrack {
  VectorCurve curve = VectorCurve::linear;
  std::vector<double> times;     // [keys]
  std::vector<Vec3> values;      // [keys]
  std::vector<Vec3> velocities;  // [keys] for hermite and monotone, otherwise empty
};

// Keys of a rotation, unit quaternions of either sign.
struct RotationTrack {
  RotationCurve curve = RotationCurve::slerp;
  std::vector<double> times;     // [keys]
  std::vector<Quat> values;      // [keys]
  std::vector<Vec3> velocities;  // [keys] for squad: radians per second in the key's local frame
};

struct KeyedJoint {
  VectorTrack position;    // without keys that of the reference pose
  RotationTrack rotation;  // without keys that of the reference pose
  VectorTrack scale;       // without keys 1
};

struct KeyedClip {
  Skeleton skeleton;
  double duration = 0;             // seconds, >= 0; keys are in [0, duration]
  std::vector<KeyedJoint> joints;  // [joints]
  Provenance provenance;

  // Total over all tracks.
  std::size_t key_count() const;
};

// Sets the curve and computes the velocities that it needs from the keys, for hermite and squad
// with the tension (0 is smoothest, 1 stops at each key). Ends::closed: the last key repeats the
// first, and the looped motion is smooth there.
void set_curve(VectorTrack& track, VectorCurve curve, double tension = 0, Ends ends = Ends::open);
void set_curve(RotationTrack& track, RotationCurve curve, double tension = 0,
               Ends ends = Ends::open);

// Checks everything documented above: check(skeleton), a KeyedJoint for each joint, arrays of equal
// length, finite values, times strictly increasing within [0, duration], unit rotations (within
// 1e-3), a finite duration >= 0. Codes: those of check(Skeleton), keyed-shape, keyed-time,
// keyed-value.
Status check(const KeyedClip& clip);

// One key per frame, linear and slerp: lossless. Each rotation of a track is in the hemisphere of
// the previous one.
KeyedClip keyed_clip(const Clip& clip);

// The motion sampled at i / rate, with the number of frames and the error codes of frames_within().
// A scale moves joints below it but does not rotate them (joints of a Clip have no scale). A clip
// without keys gives no frames.
Result<Clip> uniform_clip(const KeyedClip& clip, double rate);

// As retime() of lib/motion (`keep_last`: LastFrame::kept), but between the frames positions
// relative to the parent follow Hermite cubics and rotations squad curves, with velocities for
// `tension` (tension_velocities(), 0 to 1): smooth where retime() bends at each frame, as of
// motions with few frames. Values at the frames themselves are those of retime() within the
// rounding of floats. Codes: motion-speed unless the speed is positive and finite and the tension
// from 0 to 1; clip-rate, clip-too-long as frames_within().
Result<Clip> retime_on_curves(const Clip& clip, double rate, double speed, double tension,
                              bool keep_last);

}  // namespace krok
