#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/result.h"
#include "motion/local_motion.h"
#include "ragdoll/bodies.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/skeleton.h"

// Getting up: from lying still into a captured motion.

namespace krok::ragdoll {

// The height of the ground at (x, z), metres; nothing where there is none.
using GroundHeight = std::function<std::optional<double>(double x, double z)>;

// How deep a body is in the ground in a pose (joint_to_world, shape [joints]), metres; negative
// above it, by the corners of boxes and the lowest points of round shapes.
double depth_in_ground(const Body& body, std::span<const Transform> pose,
                       const GroundHeight& ground);

// The deepest body of a pose.
double depth_in_ground(const std::vector<Body>& bodies, std::span<const Transform> pose,
                       const GroundHeight& ground);

// Lifts bodies out of the ground from frame `begin` on: moves the root up and turns other bodies
// about their joints, smoothed over time (a Gaussian of `smoothing` seconds) against jerks; what
// that leaves deeper than 3 mm lifts the whole body. The correction fades in over the first frames
// from `begin`. A motion with nothing deeper than 3 mm stays as it is. `rate` is frames per second.
// The root is the joint that carries the body, as of clips rooted at the hips (HipsRoot).
void clear_ground(const Skeleton& skeleton, const std::vector<Body>& bodies,
                  const GroundHeight& ground, int begin, double rate, double smoothing,
                  LocalMotion& motion);

// How near the first frame of a motion is to a lying pose: the root mean square distance of points
// on the bodies, weighted by mass, after the motion is turned about the vertical and moved along
// the ground to where that is least (as point clouds in Kovar et al., "Motion graphs", 2002),
// metres.
struct RiseChoice {
  int motion = -1;        // of those given
  bool mirrored = false;  // left and right exchanged
  double distance = 0;
};

struct GetUpOptions {
  bool mirror = true;              // try the motions' mirror images too
  GroundHeight ground;             // empty: level, at height 0
  double max_acceleration = 1.25;  // of the way there, in units of RisenClip::motion_acceleration
};

struct RisenClip {
  Clip clip;            // the fall up to `first_frame`, the way there, then the motion
  int first_frame = 0;  // of the way there: what lies begins to move
  int handover = 0;     // the first frame that is the motion's alone
  RiseChoice choice;
  std::vector<RiseChoice> tried;  // the best of each motion
  // Radians/s^2: the largest angular acceleration of a joint relative to its parent on the way to
  // the motion, and the motion's 99th percentile among joints with bodies.
  double acceleration = 0, motion_acceleration = 0;
  double depth = 0;       // metres: the deepest that a body is in the ground from `first_frame` on
  bool crouches = false;  // the motion begins standing, so that a crouch was put before it
};

// Finds the motion of `motions` that is nearest to the pose of `fall` at a frame. The motions have
// the skeleton's joints. Codes: motion-skeleton, ragdoll-rise for a motion without frames or no
// motion.
Result<std::vector<RiseChoice>> choose_rise(const Clip& fall, int frame,
                                            std::span<const Clip> motions, const RoleMap& roles,
                                            const std::vector<Body>& bodies, bool mirror);

// Lets a character that lies still at `frame` of `fall` get up with the nearest of `motions`, which
// begin lying and stand on y = 0. One that begins standing follows standing up from a crouch with
// fingertips on the ground: no one rises from lying as a whole. The motion is placed where its
// first pose is nearest; the remaining difference is removed joint by joint along a quintic in time
// (the smoothest way from rest to rest, Flash and Hogan 1985), while the motion begins slowly, so
// that neither speeds nor accelerations jump. How long that takes follows from how far it is and
// how fast the motion moves, 1.4 s at most: people who get up do not wait for their slowest joint.
// Bodies that come into the ground are lifted out of it (clear_ground()).
//
// Poses are summed with the root at the hips (HipsRoot), so that a root above them does not matter.
//
// Codes: those of choose_rise(); ragdoll-rise for a result that is not finite or takes a body more
// than 0.3 m into the ground.
Result<RisenClip> get_up(const Clip& fall, int frame, std::span<const Clip> motions,
                         const RoleMap& roles, const std::vector<Body>& bodies,
                         const GetUpOptions& options);

}  // namespace krok::ragdoll
