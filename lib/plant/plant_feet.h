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
  // Metres, how far apart the positions of the point are during the stay.
  double drift_before = 0, drift_after = 0;
};

struct PlantedFeet {
  Clip clip;
  std::vector<FixedStay> stays;  // left foot before right, heel, ball, tip, then by frame
  // The largest over all stays of heels and balls, metres.
  double drift_before = 0, drift_after = 0;
  // Between strike and toe-off, before and after the stays: where the foot rolls over heel, ball or
  // tip, which then do not move along the ground. Drifts are along the ground, metres.
  std::vector<FixedStay> rolls;  // left foot before right
  double roll_before = 0, roll_after = 0;
  double pelvis_lowered = 0;  // metres, the most in any frame
  double body_steadied = 0;   // metres, root mean square of the jitter taken out of the whole body
  int out_of_reach = 0;       // frames in which a leg is too short for its place
  // Of the time from strike to toe-off (find_gait()), of both feet, the part in which a point of
  // the foot stays; in the rest the foot moves as captured. None without a whole stance.
  std::optional<double> stance_share;
  Diagnostics warnings;
};

// Moves the feet so that heel and ball do not move while they stand, and the rest of the body no
// more than that needs. `contacts` tells when they stand, as a sidecar does: contacts of other
// joints are left out, and points that no joint marks, such as the ball of a foot without a toe
// joint, take their stays from find_contacts(). Without contacts find_contacts() tells all.
//
// - Each stay has one place: the median of the point over its frames, of heights that jitter evenly
//   their trimmed mean. Heel and ball keep their distance. Heights of one part over all stays are
//   drawn to a common plane as far as jitter alone explains their difference (shrinkage, James and
//   Stein 1961), so that stairs keep theirs.
// - While heel and ball both stand, the foot is turned onto their places by the shortest rotation.
//   While one of them stands, the foot turns about it as captured: the roll over heel and ball
//   stays. Its ankle is led smoothly there, and the foot turned a little more or less, so that
//   knees do not take over what feet shake by. While the tip alone stands, the foot nearly turns
//   about the tip. Toes keep lying flat.
// - Before its first stay and after its last one a stance of find_gait() rolls: in each frame the
//   lowest point of the foot, compared with a flat foot, does not move along the ground, and the
//   height stays as captured. Where it slides by more than 0.07 of the leg it is of a step.
// - Between stays the correction is the curve of least curvature under a little tension, drawn to
//   zero where stays are far apart.
// - Jitter that feet and pelvis share is taken out of the whole body: a leg between a fixed foot
//   and a pelvis that jitters would shake.
// - A leg that is nearly straight is not stretched further than captured: the heel comes up further
//   in stays of ball or tip and in rolls (15 and 30 degrees at most), then the pelvis is lowered.
// - Legs are solved by solve_two_bone(). Bend that is added is about the knee's usual axis, also to
//   a knee that is straight or bent backwards.
//
// Feet that stand still show longer stays than feet that slide. Where stays are found, they are
// looked for again on the result, and held as well. Frames in which a point is higher or lower than
// the rest of a stay that was found, by 0.012 of the leg and three deviations of its jitter, are of
// a step: a heel that rises is not pressed down.
//
// Planting twice is planting once, with the same contacts and with contacts detected again: the
// passes go on, 8 at most, until one finds no heel and no ball that moves by more than 0.0004 of
// the leg while it stands. Of a stay that was found and in which a point is that still for half of
// the time or more, the rest is of steps. A clip in which nothing is to correct is returned as it
// is; so is, without contacts given, one in which a point of the foot moves by less than 0.0001 of
// the leg in 0.4 of the frames of every stance or more: captures do not.
//
// Everything outside the legs keeps its orientation, and its position relative to the hips; joints
// above the hips do not move. Bones keep their lengths. Root and reference pose do not matter.
// Frames of a rest pose before the capture, from which a foot jumps, are not fixed.
//
// Codes: those of check(Clip); contacts-feet where the roles know no leg from hip to foot;
// plant-contacts where no foot stands at any frame. Warnings: plant-reach (a leg is too short for
// its place), plant-missed (two stances of find_gait() or more, and a fifth of all, have no
// contact), and those of find_contacts().
Result<PlantedFeet> plant_feet(const Clip& clip, const RoleMap& roles,
                               std::optional<std::span<const Contact>> contacts = {});

}  // namespace krok
