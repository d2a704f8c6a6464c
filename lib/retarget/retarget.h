#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "math/transform.h"
#include "retarget/foot_points.h"
#include "roles/roles.h"
#include "scene/frame_source.h"
#include "scene/skeleton.h"

// Retargeting: transfers a motion from one skeleton to another.
//
// A joint's world rotation from the reference pose to the animated pose is transferred, so that the
// joint axes of the two skeletons do not matter. Before that the target's reference pose is aligned
// with the source's: limbs point the same way, hips and chest face the same way. Between chains
// with different numbers of joints (spine, neck), rotations are spread along their length. The hips
// move as the source's, scaled by the length of the legs. Skeletons mapped by names are raised or
// lowered so that their lowest mapped joints are equally high in the reference pose.

namespace krok::retarget {

enum class Feet {
  keep,  // ankles and balls of the feet where the source's are, scaled: no foot skate, no
         // sinking into the floor
  free   // as the legs' rotations place them
};

// Hands, elbows, knees and seat on the ground, hands on each other and on the body.
enum class Touches {
  keep,  // what touches in the source touches in the result, at the same height and distance,
         // scaled
  free   // as rotations place them
};

struct Options {
  Feet feet = Feet::keep;
  Touches touches = Touches::keep;  // of the ground only with Feet::keep

  // Lengths in the target's motion over those in the source's; by default the ratio of the legs.
  std::optional<double> scale = std::nullopt;

  // The height of the floor under the target's reference pose (metres), from a mesh standing on it.
  // By default the height of the lowest joint of its feet.
  std::optional<double> target_floor = std::nullopt;
  // Points of the target's feet that are to be no deeper in the floor than the source's, as
  // points_of_feet() of that mesh. By default its joints and usual tips of the toes.
  std::vector<BodyPoint> target_feet = {};

  // Frames used as reference poses, for skeletons whose own is not an upright stance. By default
  // the skeleton's own if it is upright, otherwise one built from it (retarget/stance.h).
  std::optional<int> source_frame = std::nullopt;
  std::optional<int> target_frame = std::nullopt;
  // Poses used instead, from anywhere: joint_to_world, shape [joints]; empty: none.
  std::vector<Transform> source_pose = {};
  std::vector<Transform> target_pose = {};

  int jobs = 0;                  // threads; 0: one per processor
  Progress* progress = nullptr;  // reports frames done; may be null
};

// How the joints of the two skeletons were mapped.
enum class Method {
  same_skeleton,  // same joints and bones, uniformly scaled: orientations are copied
  roles,          // by joint roles
  names           // by equal names
};

struct MappedJoint {
  int target = -1;
  int source = -1;
  int second_source = -1;  // if interpolated between two joints of a chain, otherwise -1
  double share = 0;        // weight of second_source
  double alignment = 0;    // radians the reference pose was turned by here
  double heading = 0;      // of those about the vertical, relative to the hips; -pi to pi
};

struct FootReport {
  double largest_correction = 0;  // metres the ankle was moved from where rotations put it
  int largest_correction_frame = -1;
  double largest_miss = 0;  // metres by which a leg was too short for its goal
  int largest_miss_frame = -1;
  double largest_bend = 0;  // radians by which the knee is more or less bent than the source's
  int largest_bend_frame = -1;
  // Metres by which a point of the foot is deeper in the floor than the source's foot, scaled.
  double largest_depth = 0;
  double largest_depth_time = 0;  // seconds
  int largest_depth_joint = -1;   // of the target; -1 if none is deeper
};

// A stretch of time in which the source touches something, and what became of it.
struct ContactReport {
  std::string part;           // "left hand", "left foot"
  int joint = -1;             // of the target, of that part
  std::string on;             // "ground", "right hand", "left thigh"
  double start = 0, end = 0;  // seconds
  // On the ground: the mean horizontal speed of the part in the result and in the source, metres
  // per second; the largest difference of its height from the source's, scaled, metres.
  double slide = 0, source_slide = 0, height = 0;
  double apart =
      0;  // on the body: largest difference of distance from the source's, scaled, metres
};

struct Report {
  Method method = Method::roles;
  double scale = 1;
  double path_scale = 1;            // horizontal ways of the result over the source's
  double floor = 0;                 // height of the floor in the result, metres
  std::optional<int> source_frame;  // used as reference pose, if any
  std::optional<int> target_frame;
  // The poses in which both actors were taken to stand alike: joint_to_world, shape [joints]. As
  // Options::source_pose and target_pose they give the same alignment for any motion.
  std::vector<Transform> source_pose, target_pose;
  std::vector<MappedJoint> mapped;    // in the order of the target's joints
  std::vector<int> unused_source;     // joints whose motion is lost, without end sites
  std::vector<int> following_target;  // joints that only follow their parent, without end sites
  bool left_fingers_at_rest = false;  // the source has fingers there that never move
  bool right_fingers_at_rest = false;
  std::vector<ContactReport> contacts;  // by roles; by start
  double largest_shift = 0;  // metres the hips were moved so that limbs reach what they touch
  double largest_turn = 0;   // radians the trunk was turned for that
  double largest_drop = 0;   // metres the hips were lowered so that legs reach the floor
  std::optional<FootReport> left_foot, right_foot;  // with Feet::keep
  // By roles: the joint of hands and head that goes deepest into the floor, metres deeper than any
  // of the source's hand or head there, scaled. Joint of the target; -1 if none does.
  double largest_depth = 0;
  double largest_depth_time = 0;  // seconds
  int largest_depth_joint = -1;
};

struct Retargeted {
  Clip clip;  // the target's skeleton, the source's rate and frames; no provenance
  Report report;
};

// Retargets `source` to the skeleton of `target`. Both clips must pass check(); role maps are those
// of their joints. The target's own motion, which may have no frames, is used only if its reference
// pose is not a stance, and for the thickness of its soles. Needs two humanoids, or skeletons that
// share at least 60 % of the joint names of the smaller one. A source on its own skeleton is
// returned bit for bit, whatever its joints are called there; on a uniformly scaled copy, scaled.
// Likewise if either skeleton has more joints (same_person()): those that the target alone has
// follow their parents.
// The result is bit-identical for any `jobs`.
//
// Errors: retarget-empty (no joints), retarget-roles (neither applies; the message names the
// missing roles), retarget-scale (not positive and finite), retarget-frame (no such frame),
// retarget-pose (a pose of another number of joints).
Result<Retargeted> transfer(const Clip& source, const RoleMap& source_roles, const Clip& target,
                            const RoleMap& target_roles, const Options& options);

// The height of the ground below a point (metres, world) or just above it; empty where there is
// none.
using GroundHeight = std::function<std::optional<double>(const Vec3& point)>;

struct RetargetedFrames {
  FrameSource frames;              // to be read about in order
  std::shared_ptr<Report> report;  // complete, but for what frames show until all were read
  // Measures Report::contacts in frames made from all of these by laying them on the ground of the
  // source, at the source's places. Heights are those over the ground. Null with same_skeleton.
  std::function<Status(const FrameSource& laid, const GroundHeight& ground)> measure_contacts = {};
};

// The same of frames generated on demand, in blocks, in memory that hardly grows with their number
// (about 60 bytes a frame): the result does not depend on `block_frames`. Contacts are those of
// find_in_long_take(); heels and T-poses come from eight parts of 2048 frames, all of a shorter
// take. The frames are read four times beforehand. The arguments must outlive the result.
Result<RetargetedFrames> transfer(const FrameSource& source, const RoleMap& source_roles,
                                  const Clip& target, const RoleMap& target_roles,
                                  const Options& options, int block_frames = 4096);

}  // namespace krok::retarget
