#pragma once

#include "core/result.h"
#include "scene/clip.h"

// Makes a motion repeat without a seam.
//
// A clip of n frames lasts (n - 1) / rate, so a looped clip ends with its first pose: the last
// frame is the first one moved by the loop's displacement (a translation and a turn about the
// vertical, zero for a motion in place). To play it, show frames 0 .. n - 2, then frame 0 moved by
// the displacement, moved twice in the next cycle, and so on. The period is n - 1 frames.

namespace krok {

// What the input's last frame is.
enum class LoopEnd {
  automatic,  // `open` if one more step from the last pose leads to the first and the last pose is
              // not the first already; otherwise `closed`
  closed,     // the first pose again; it is made equal to the first
  open        // the pose before the first; a closing frame is added
};

// Up to this turn over one cycle, in radians, counts as drift.
inline constexpr double kLoopDrift = 10 * kRadiansPerDegree;

// How the turn over one cycle is treated.
enum class LoopTurn {
  automatic,  // up to kLoopDrift is drift and is removed; larger turns are kept
  keep,       // the loop follows a circle
  straighten  // the path is straightened, as straighten() does
};

// How the height gained over one cycle is treated.
enum class LoopClimb {
  automatic,  // up to 5 % of the skeleton's extent is blended away; more is kept
  keep,       // stairs
  level       // blended away at the seam
};

struct LoopOptions {
  double blend = 0.2;  // seconds before and after the seam that may change; at most half the clip
  LoopEnd end = LoopEnd::automatic;
  LoopTurn turn = LoopTurn::automatic;
  LoopClimb climb = LoopClimb::automatic;
};

// The mismatch between end and start after removing the displacement. Rotations are relative to the
// parent. Velocities are the velocity jumps at the seam, from parabolas of equal curvature through
// two frames on either side; a smooth motion also has some where its acceleration changes.
struct Seam {
  double angle = 0;             // radians, the largest of all joints
  double distance = 0;          // metres, of the root and joints that move in their parents
  double angular_velocity = 0;  // radians per second
  double velocity = 0;          // metres per second
  int angle_joint = 0, angular_velocity_joint = 0;
  // 95th percentile of the same measure inside the motion, for the same joint.
  double usual_angular_velocity = 0;
};

struct Looped {
  Clip clip;
  Seam before, after;
  int added_frames = 0;     // 0 or 1
  Transform displacement;   // world_to_world: maps the first frame to the last
  double turn = 0;          // radians about the vertical, part of the displacement
  double straightened = 0;  // radians of turn removed
  double levelled = 0;      // metres of height blended away
  int blended_frames = 0;   // before the seam, and as many after it
  // A root that stood still now travels along, evenly: the character is moved on by moving all of
  // it.
  bool carried = false;
};

// The seam is closed by adding to each joint's rotation, and to the places of the root and of
// joints that move in their parents, a curve that is half of what is missing at the seam, in value
// and in velocity, and fades to nothing with two derivatives within the blend (a quintic Hermite
// curve). Of a jump in velocity only what is more than the joint's usual is missing, so that a
// motion that repeats already stays as it is. The loop of a loop is the loop, within 0.1 mm for a
// person's size. Poses then agree across the seam, and velocities as well as elsewhere; bones keep
// their lengths; frames further away stay as they are, except for what straightening does. Poses
// are those of the hips and the joints below, whatever the root above them does (HipsRoot).
// `carrier` is what carrying_joint() gives. Codes: motion-loop for clips of fewer than four frames,
// motion-blend for a blend that is negative or not finite.
Result<Looped> loop(const Clip& clip, int carrier, const LoopOptions& options);

// The loop's turn taken out evenly over time: it goes straight on, at the velocity with which the
// arc from its first place to its last begins, and sways about that line as it did about the arc.
// Moved at this velocity and turned at the rate that was taken out (carried_along in travel.h) it
// is the loop before, up to float rounding, so feet that stood on the ground do so then.
void straighten(int carrier, Looped& looped);

// The clip played `rounds` times as described above, as one motion of rounds * (n - 1) + 1 frames.
// Requires rounds >= 1. Code clip-too-long above 100 million joint transforms.
Result<Clip> repeated(const Clip& looped, const Transform& displacement, int rounds);

}  // namespace krok
