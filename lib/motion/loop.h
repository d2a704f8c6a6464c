#pragma once

#include "core/result.h"
#include "scene/clip.h"

// Making a motion repeat without a seam.
//
// A clip of n frames lasts (n - 1) / rate, so a looped clip ends with the pose it begins with: its
// last frame is its first one moved by the loop's displacement (a turn about the vertical and a
// way, zero for a motion on the spot). To play it, show frames 0 .. n - 2, then go on with frame 0
// moved by the displacement, twice moved the round after, and so on. The period is n - 1 frames.

namespace krok {

// What the last frame of the input is.
enum class LoopEnd {
  automatic,  // `open` where the first pose follows on the last one as one more step would, and the
              // last is not the first already; otherwise `closed`
  closed,     // the first pose again: it is made equal to it
  open        // the one before: a closing frame is added
};

// What becomes of the turn that the figure makes in one round.
enum class LoopTurn {
  automatic,  // up to ten degrees are a drift and are taken out, more are kept
  keep,       // the loop goes round a circle
  straighten  // the way is bent straight: its direction is turned back evenly over time
};

// What becomes of the height that the figure gains in one round.
enum class LoopClimb {
  automatic,  // up to 5 % of the figure's extent are blended away, more are kept
  keep,       // stairs
  level       // blended away at the seam
};

struct LoopOptions {
  double blend =
      0.2;  // seconds before the seam and after it that may change; at most half the clip
  LoopEnd end = LoopEnd::automatic;
  LoopTurn turn = LoopTurn::automatic;
  LoopClimb climb = LoopClimb::automatic;
};

// How far the end is from going over into the beginning, the displacement taken out. Rotations are
// relative to the parent. Velocities are the jumps of velocity at the seam, from parabolas of equal
// curvature through two frames on either side; even a smooth motion has some, where it is jerky.
struct Seam {
  double angle = 0;             // radians, of the joint where it is largest
  double distance = 0;          // metres, of the root or a joint that moves in its parent
  double angular_velocity = 0;  // radians a second
  double velocity = 0;          // metres a second
  int angle_joint = 0, angular_velocity_joint = 0;
  // The same measure within the motion, for the same joint: what 19 of 20 frames stay below.
  double usual_angular_velocity = 0;
};

struct Looped {
  Clip clip;
  Seam before, after;
  int added_frames = 0;     // 0 or 1
  Transform displacement;   // world_to_world: takes the first frame to the last
  double turn = 0;          // radians; the turn about the vertical within the displacement
  double straightened = 0;  // radians of turn taken out
  double levelled = 0;      // metres of height blended away
  int blended_frames = 0;   // before the seam, and as many after it
  bool carried = false;     // a root that stood still now travels along
};

// The seam is closed by adding to each joint's rotation, and to the places of the root and of
// joints that move in their parents, a curve that is half of what is missing at the seam, in value
// and in velocity, and fades to nothing with two derivatives within the blend (a quintic Hermite
// curve). Of a jump in velocity only what is more than the joint's usual is missing, so that a
// motion that repeats already stays as it is. Poses then agree across the seam, and velocities as
// well as elsewhere; bones keep their lengths; frames further away stay as they are, except for
// what straightening does. `carrier` is what carrying_joint() gives. Codes: motion-loop for clips
// of fewer than four frames, motion-blend for a blend that is negative or not finite.
Result<Looped> loop(const Clip& clip, int carrier, const LoopOptions& options);

// The clip played `rounds` times as told above, as one motion of rounds * (n - 1) + 1 frames.
// Needs rounds >= 1. Code clip-too-long beyond 100 million joint transforms.
Result<Clip> repeated(const Clip& looped, const Transform& displacement, int rounds);

}  // namespace krok
