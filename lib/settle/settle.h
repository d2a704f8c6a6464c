#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "ragdoll/bodies.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "terrain/terrain.h"

// Lays a motion that was made on level ground onto any other: falls, crawls, sitting, kneeling.

namespace krok {

struct SettleOptions {
  // Height of the level ground that the motion was made on, metres. Without: found from what lies
  // or stands on it.
  std::optional<double> floor;
  // A mesh whose vertices are laid on the ground instead of the bodies of ragdoll::make_bodies().
  // Its skeleton has the same joints.
  const Model* model = nullptr;
  int jobs = 0;
};

// A part of the body that touches the ground for a while.
struct SettledTouch {
  std::string part;         // "left_hand", as ragdoll::Body::name
  int first = 0, last = 0;  // frames, inclusive
  double hover = 0;         // metres, max height of its lowest point above the ground
  double depth = 0;         // metres, max depth in the ground
};

// How a motion lies on a ground. Metres.
struct GroundFit {
  double depth = 0;  // max depth of any part in the ground, in any frame
  double hover = 0;  // max height of a part that touches above what it rests on
};

struct Settled {
  Clip clip;                          // of settle(Clip)
  FrameSource frames;                 // of settle(FrameSource); reads the source again
  std::vector<SettledTouch> touches;  // by part, then by frame; as measured on the result
  GroundFit before, after;
  double floor = 0;         // metres, given or found
  double largest_turn = 0;  // radians, of a joint relative to its parent
  int turned_joint = -1;
  // The 99th percentile of the parts' jerk (third derivative of places), result over input; 1 if
  // the motion stays as it is.
  double jerk = 1;
  Diagnostics warnings;
};

// Moves the body as a whole and turns its joints so that every part that is near the ground in the
// source is as far above `ground`, and parts that touch neither hover nor sink in. Where people lie
// or crawl, the trunk follows the ground's slope; while they are upright it stays upright. Parts
// keep their places over the ground (x, z) as far as they can. What is changed is as smooth in time
// as the ground allows: all frames are solved together (Levenberg and Marquardt's least squares),
// with second differences of the change as a part of the error. Knees and elbows turn about their
// usual axes, and do not bend backwards. Bones keep their lengths.
//
// Where the ground has steps, what lies rests on a ramp over their edges, as a ball rolls over
// them; the feet of an upright body rest on the treads, may reach over an edge, and from one tread
// to another pass over the ramp. Where a part cannot do both, it rather hovers than sinks in.
// Points over no ground are free; if there is no ground under the hips in any frame the result is
// an error.
//
// A motion that touches `ground` as much and as closely as it does a level floor, with no part
// deeper than 10 mm, or longer, with none deeper than 5 mm, or a quarter as long, where it would be
// more than 10 mm deep in the level floor, is returned as it is: what came out within 5 mm is not
// settled again. The exception are skeletons whose reference pose shows no body
// (retarget::neutral_skeleton()): theirs is found from the motion, so that the second time other
// parts may be in the ground. What would come out further off than it is (the larger of depth and
// hover) is returned as it is, too.
//
// Codes: those of check(Clip) and ragdoll::make_bodies(); settle-ground. Warnings: settle-depth and
// settle-hover, for more than 5 mm with the part and frame; settle-partly, frames with no ground
// under the hips.
Result<Settled> settle(const Clip& clip, const RoleMap& roles, const Terrain& ground,
                       const SettleOptions& options = {});
// The same of frames that are produced on demand, of which about 1 kB each is kept for a body of 16
// parts. Errors are those of the source as well.
Result<Settled> settle(const FrameSource& source, const RoleMap& roles, const Terrain& ground,
                       const SettleOptions& options = {});

}  // namespace krok
