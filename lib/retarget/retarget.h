#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/skeleton.h"

// A motion of one skeleton on another.
//
// A joint's rotation is carried over as the rotation of the world that takes it from the reference
// pose to the animated one, so that the axes of joints in the two skeletons do not matter. Before
// that the target's reference pose is brought to the source's: limbs point the same way, hips and
// chest face the same way. Where chains have different numbers of joints (spine, neck), rotations
// are spread along their length. The hips move as the source's, scaled by the length of the legs.

namespace krok::retarget {

enum class Feet {
  keep,  // ankles and balls of the feet where the source's are, scaled: no sliding, none in the
         // floor
  free   // as the legs' rotations bring them
};

struct Options {
  Feet feet = Feet::keep;

  // Lengths in the target's motion over those in the source's; by default the ratio of the legs.
  std::optional<double> scale = std::nullopt;

  // The height of the floor under the target's reference pose (metres), from a mesh that stands on
  // it. By default the lowest joint of its feet counts as the floor.
  std::optional<double> target_floor = std::nullopt;

  // Frames that serve as reference poses, for skeletons whose own is no upright stance. By default
  // the skeleton's own, unless it does not stand; then the frame that comes nearest to a T-pose.
  std::optional<int> source_frame = std::nullopt;
  std::optional<int> target_frame = std::nullopt;

  int jobs = 0;                  // threads; 0: as many as processors
  Progress* progress = nullptr;  // told of frames while retarget() runs; may be null
};

// How the joints of the two skeletons were brought together.
enum class Method {
  same_skeleton,  // the same joints and bones, scaled evenly: orientations as they are
  roles,          // by their parts in a human body
  names           // by equal names
};

struct MappedJoint {
  int target = -1;
  int source = -1;
  int second_source = -1;  // where a rotation is taken from between two joints of a chain; or -1
  double share = 0;        // of the second
  double alignment = 0;    // radians that the reference pose was turned by here
};

struct FootReport {
  double largest_correction = 0;  // metres that the ankle was moved beyond what rotations gave
  int largest_correction_frame = -1;
  double largest_miss = 0;  // metres by which a leg was too short for its goal
  int largest_miss_frame = -1;
};

struct Report {
  Method method = Method::roles;
  double scale = 1;
  double floor = 0;                 // height of the floor in the result, metres
  std::optional<int> source_frame;  // that served as reference pose, where one did
  std::optional<int> target_frame;
  std::vector<MappedJoint> mapped;    // in the order of the target's joints
  std::vector<int> unused_source;     // joints whose motion is lost, end sites left out
  std::vector<int> following_target;  // joints that keep their place on their parent, likewise
  bool left_fingers_at_rest = false;  // the source has fingers there that never move
  bool right_fingers_at_rest = false;
  double largest_drop = 0;  // metres that the hips came down so that legs reach the floor
  std::optional<FootReport> left_foot, right_foot;  // where feet were kept
};

struct Retargeted {
  Clip clip;  // the target's skeleton, the source's rate and frames; no provenance
  Report report;
};

// Moves the skeleton of `target` as `source` moves. Both clips must pass check(); role maps are
// those of their joints. The target's own motion, which may have no frames, only serves where its
// reference pose is no stance. Needs two humanoids, or skeletons that share most of their names. A
// source on its own skeleton comes back bit for bit; on an evenly scaled copy, scaled. The same
// bytes for any `jobs`.
//
// Errors: retarget-empty (no joints), retarget-roles (neither works; the message says what roles
// are missing), retarget-scale (not positive and finite), retarget-frame (no such frame).
Result<Retargeted> transfer(const Clip& source, const RoleMap& source_roles, const Clip& target,
                            const RoleMap& target_roles, const Options& options);

}  // namespace krok::retarget
