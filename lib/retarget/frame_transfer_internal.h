#pragma once

#include <array>
#include <optional>
#include <vector>

#include "math/transform.h"
#include "retarget/foot_placement.h"
#include "retarget/joint_mapping.h"
#include "retarget/retarget.h"
#include "retarget/touch_keeping.h"
#include "scene/frame_source.h"
#include "scene/skeleton.h"

namespace krok::retarget {

struct PlacedLeg {
  LegPlacement placement;
  LegPlacement::Stances stances;
  bool is_left = false;
};

// The joints of a part that is not moved for the floor, in both actors.
struct AboveFloor {
  std::vector<int> source, target;
};

// How the frames of a motion are transferred; the same for all of them.
struct TransferPlan {
  JointMapping mapping;          // [target joints]
  std::vector<Quat> rest_back;   // [source joints], conjugated orientations of the reference pose
  std::vector<Transform> local;  // [target joints], reference joint_to_parent
  std::vector<Quat> aligned;     // [target joints], orientations of the aligned reference pose
  int anchor = 0;                // the target joint that carries the root motion
  std::array<int, 2> source_sides = {0, 0};  // joints whose midpoint is transferred
  std::array<int, 2> target_sides = {0, 0};
  double scale = 1;         // lengths of the target over those of the source
  double rise = 0;          // metres the target's hips are raised for the height of its ankles
  double floor = 0;         // height of the floor in the result, metres
  double source_floor = 0;  // likewise in the source
  std::vector<AboveFloor> above_floor;  // hands and head; by roles alone
  std::vector<PlacedLeg> legs;          // empty with Feet::free
  GroundStays stays;                    // of all frames
  std::vector<KeptContact> kept;        // likewise
  double leg_length = 0;                // metres, of the target; unused without legs and touches
};

// Notes in `touches`, which are those of `run`, where the target is by rotations alone, as far as
// they need it: `again` for settle() alone.
void note_touches(const FrameRun& run, const Skeleton& target, const TransferPlan& plan, int jobs,
                  bool again, TouchKeeping& touches);

// The frames of `run` on the skeleton `target`. Adds to `report` what the legs needed in the frames
// that are kept: the two feet, largest_drop and what touches. `touches` are settled; null: none are
// kept. `poses` is memory to be used again for other blocks.
Clip transfer_frames(const FrameRun& run, const Skeleton& target, const TransferPlan& plan,
                     int jobs, const TouchKeeping* touches, std::vector<Transform>& poses,
                     Report& report);

// Adds the contacts of a block of frames to those of the blocks before it. Those that began in
// earlier frames go on.
void add_contacts(std::vector<ContactReport> found, std::vector<ContactReport>& all);

}  // namespace krok::retarget
