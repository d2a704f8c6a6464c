#pragma once

#include <optional>
#include <span>
#include <vector>

#include "contacts/sole_points.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Foot skate clean-up: feet that stay where they stand.

namespace krok {

// A stay of one point of a sole that was fixed, in whole frames.
struct FixedStay {
  SolePoint point;
  int first = 0, last = 0;    // frames, inclusive
  Vec3 place = Vec3::Zero();  // of the point, metres, world
  // Metres, the diagonal of the box that the point moves in during the stay.
  double drift_before = 0, drift_after = 0;
};

struct PlantedFeet {
  Clip clip;
  std::vector<FixedStay> stays;  // left foot before right, heel, ball, tip, then by frame
  // The largest over all stays of heels and balls, metres.
  double drift_before = 0, drift_after = 0;
  double pelvis_lowered = 0;  // metres, the most in any frame
  double body_steadied = 0;   // metres, root mean square of the jitter taken out of the whole body
  int out_of_reach = 0;       // frames in which a leg is too short for its place
  Diagnostics warnings;
};

// Moves the feet so that heel and ball do not move while they stand, and nothing else more than
// that needs. `contacts` tells when they stand, as a sidecar does (contacts of other joints are
// left out; a point that no joint marks takes its stays from find_contacts()); without it
// find_contacts() tells all.
//
// - Each stay has one place: the median of the point over its frames. Heel and ball keep their
//   distance. Heights of one point over all stays are drawn together as far as jitter alone
//   explains their difference (shrinkage by James and Stein), so that stairs and slopes keep
//   theirs.
// - While heel and ball both stand the foot is turned onto their places by the shortest rotation;
//   while one of them stands the foot turns about it as captured: the roll over the heel and over
//   the ball stays. While the tip alone stands the foot turns about the tip.
// - Between stays, correction of place and rotation is the curve of least curvature, drawn to zero
//   where stays are far apart: no frame is more than a second from where it bends.
// - Jitter that feet and pelvis share is taken out of the whole body, for a leg between a fixed
// foot
//   and a pelvis that jitters would shake.
// - Where a leg would be stretched further than captured, and is nearly straight, the pelvis is
//   lowered smoothly first.
// - Legs are solved by solve_two_bone(). Bend that is added bends the knee about its usual axis.
//
// A clip in which no heel and no ball moves by more than 0.0005 of the leg while it stands is
// returned as it is, so that planting twice with the same contacts is the same as once.
//
// Everything outside the legs keeps its orientation, and its position relative to the hips; joints
// above the hips do not move. Bones keep their lengths. Independent of root and reference pose.
// Frames of a rest pose before the capture, from which a foot jumps, are not fixed.
//
// Codes: those of check(Clip); contacts-feet where the roles know no whole leg; plant-contacts
// where no foot stands at any frame. Warnings: plant-reach, and those of find_contacts().
Result<PlantedFeet> plant_feet(const Clip& clip, const RoleMap& roles,
                               std::optional<std::span<const Contact>> contacts = {});

}  // namespace krok
