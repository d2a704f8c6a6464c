#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

// One representation of motions for all operations that sum, interpolate or compare poses: rooted
// at the hips.
//
// In many captures the hips carry the motion, below a root that stands at the origin or slides
// along on the ground. Transforms relative to such a root are no measure of a pose: one degree of
// difference below a root five metres away is nine centimetres at the hips. Operations therefore
// work on the clip that rooted() makes, whose root is where the hips are, and restored() gives the
// joints above the hips back. Where the hips are the root neither changes anything.

namespace krok {

class HipsRoot {
 public:
  // Changes nothing.
  HipsRoot() = default;
  // For clips of one structure (names, order, parents). `carrier` is what carrying_joint() gives.
  // Each joint above the hips that stands still in all clips is restored where it stands in the
  // first; one that keeps its transform relative to the hips, or to its parent, keeps the first
  // clip's; of any other the transform relative to the hips' ground frame is part of the pose.
  // Clips without frames do not count.
  HipsRoot(std::span<const Clip* const> clips, int carrier);
  HipsRoot(const Clip& clip, int carrier);
  // The same of frames that are produced on demand, read once if there are joints above the hips.
  // Errors are those of the sources.
  static Result<HipsRoot> of(const FrameSource& source, int carrier, int jobs);
  static Result<HipsRoot> of(std::span<const FrameSource> sources, int carrier, int jobs);

  // Whether there are joints above the hips.
  bool changes() const { return !above_.empty(); }
  // Whether the root stands still.
  bool stands() const { return changes() && above_.front().keeps == Keeps::world; }
  // Where it is restored, joint_to_world; for a root that stands.
  void stand_at(const Transform& root_to_world);

  // The clip with the root at the hips: the hips' world transforms at the root, identities from
  // there down to the hips, the joints below bit for bit where they are. Joints on other branches
  // keep their transforms relative to their parents. Joints are appended for what is restored from
  // the pose. The reference pose is changed alike.
  Clip rooted(const Clip& clip) const;
  Skeleton rooted(const Skeleton& skeleton) const;

  // The inverse, for a clip on a skeleton from rooted(); `skeleton` is the original one. `carried`,
  // if set, gives world_to_world of a frame, applied to the joints that stand still.
  using Carried = std::function<Transform(int frame)>;
  Clip restored(const Clip& rooted, const Skeleton& skeleton, const Carried& carried = {}) const;

  // The original joint of a joint of rooted clips.
  int original(int joint) const;

  // Values per original joint, such as a mask's weights, for the joints of rooted clips.
  std::vector<double> rooted(std::span<const double> values) const;

  // [joints], 1 for the hips and the joints below.
  const std::vector<std::uint8_t>& below() const { return below_; }

 private:
  // What stays the same of a joint above the hips.
  enum class Keeps : unsigned char { world, to_hips, to_parent, nothing };
  struct Above {
    int joint = 0;
    Keeps keeps = Keeps::nothing;
    Transform kept;
    int appended = -1;  // its joint in rooted clips, if it keeps nothing
  };

  class KeptFinder;
  void find_joints(const Skeleton& skeleton);

  int joints_ = 0;  // of the original skeleton
  int carrier_ = 0;
  std::vector<Above> above_;  // from the root down
  std::vector<std::uint8_t> below_;
  std::vector<int> beside_;  // joints that are neither
};

// Position and heading of a character on the ground, and the joints they are taken from.

// A point on the ground (y = 0) and a heading in radians about +Y: 0 faces +Z, a quarter turn faces
// +X, the left of a character facing +Z.
struct GroundFrame {
  double x = 0, z = 0;
  double heading = 0;

  // From the character's frame (origin on the ground below it, facing +Z) to the world.
  Transform to_world() const;
};

// The joint whose position and heading count as the character's: the hips if roles are known,
// otherwise the root.
int carrying_joint(const RoleMap& roles);

// The ground frame for a carrying joint at `carrier_to_world`. The heading is the twist about +Y of
// its rotation from the reference pose, which faces +Z; leaning does not affect it.
GroundFrame ground_frame(const Skeleton& skeleton, int carrier, const Transform& carrier_to_world);

// The ground frame at one frame of a clip.
GroundFrame ground_frame(const Clip& clip, int carrier, int frame);

// Wraps an angle to [-pi, pi].
double wrapped(double angle);

// Feet, toes and the end sites below them; all joints if none has such a role. Ascending.
std::vector<int> foot_joints(const Skeleton& skeleton, const RoleMap& roles);

// 1 for `joint` and its descendants, otherwise 0. Shape [joints].
std::vector<std::uint8_t> subtree(const Skeleton& skeleton, int joint);

}  // namespace krok
