#pragma once

#include <vector>

#include "core/result.h"
#include "ragdoll/bodies.h"
#include "ragdoll/body_joints.h"
#include "ragdoll/joint_rules.h"
#include "ragdoll/world.h"
#include "scene/clip.h"

namespace krok::ragdoll {

struct Push {
  int body = 0;
  Vec3 impulse = Vec3::Zero();  // N s, world
  double time = 0;              // seconds of the motion; before the fall's begin: at it
};

struct FallOptions {
  double at = 0;        // seconds of the motion, 0 to its end: the fall begins
  double duration = 3;  // seconds of the fall, 0 to 600
  bool go_on = false;   // the motion goes on where the fall ends (go_on())
  std::vector<Push> pushes;
  BodyJointOptions joints;
  std::vector<JointRule> rules;  // of the joints, in place of those of `limits` and `joints`
  WorldOptions world;
  Surroundings surroundings;
};

struct Fall {
  Clip clip;            // at the motion's rate: its own frames before the fall, then the simulated
  int first_frame = 0;  // simulated
  // Seconds after the fall's begin from which all bodies rest on the ground; -1 if never. Rest is
  // half a second in which none moves by 2.5 cm or turns by 9 degrees; what then follows is still.
  double rest = -1;
  // Of all steps: the first 0.2 s, in which what the pose has in the ground comes out of it, and
  // the rest.
  WorldMeasures settling, largest;
  bool jumps = false;    // the motion jumps where the fall begins; the bodies began without speeds
  bool follows = false;  // not all bodies are simulated: what lies still may move again
  // Radians between the orientations of bodies and the motion, of all steps: the root mean square
  // over all bodies, and the largest.
  double mean_off = 0, largest_off = 0;
  double simulated = 0;     // seconds until it lies still, or the end
  double least_height = 0;  // metres: lowest centre of a body
};

// The pose at a time, joint_to_world; the time is clamped to the motion.
std::vector<Transform> pose_at(const Clip& clip, double time);

// Lets a motion's character fall. The bodies start from its pose at `at` and from its speeds, which
// are differences over one frame to either side; where these are more than a person can move, they
// begin without. The frames after `at` come from the bodies: the root body gives the position and
// orientation of its joint, each simulated joint has its body's orientation, all others keep their
// turn relative to their parent, and positions follow down the tree from the offsets that the pose
// has, but for bodies that slide. Joints above the root body stand still. Between steps poses are
// interpolated. The same input gives the same bytes.
//
// Bodies whose mode is animated or powered (Body::mode) follow the motion, which plays on and ends
// with its last pose; so do joints without a body of their own that they carry. Then nothing ends
// by lying still. A simulated body that hangs from an animated one is moved by it, and what touches
// an animated one does not move it.
//
// `bodies` are make_bodies()', `limits` as for make_joints(). Codes: ragdoll-time for times outside
// the motion or the ranges, ragdoll-value for pushes at bodies that are not there or not finite,
// and for a simulation that leaves 10 km around the begin of the fall, ragdoll-mode for an animated
// body below one that is not.
Result<Fall> simulate_fall(const Clip& motion, const RoleMap& roles,
                           const std::vector<Body>& bodies, const ik::Limits& limits,
                           const FallOptions& options);

// Lets a motion go on after its simulated part: the result is `simulated` to its last frame, then
// the frames of `motion` that follow it, to its end. What differs at the last frame decays within
// `span` seconds along quintics that begin with its speed and acceleration (Bollo,
// "Inertialization", 2018; timeline::Decay), each joint relative to its parent, so that neither
// jumps. Both clips have the same skeleton and rate, frame by frame. A motion without further
// frames leaves the clip as it is. Code ragdoll-value if the skeletons or rates differ.
Result<Clip> go_on(const Clip& simulated, const Clip& motion, double span);

}  // namespace krok::ragdoll
