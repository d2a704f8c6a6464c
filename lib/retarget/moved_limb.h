#pragma once

#include <span>
#include <vector>

#include "math/transform.h"
#include "retarget/pose_alignment.h"
#include "scene/skeleton.h"

// One limb of a target skeleton, moved by inverse kinematics while its end keeps its orientation.

namespace krok::retarget {

// The joint and its descendants, parents first.
std::vector<int> joints_below(const Skeleton& skeleton, int root);

class MovedLimb {
 public:
  // Thigh, shank and foot, or upper arm, forearm and hand; each must descend from the one before.
  // `hinge` is the direction of the middle joint's axis in the pose of `actor`, about which the
  // lower bone swings back (knees: to the character's left), world. While the limb is straight the
  // axis is carried by `carrier`: the upper joint, or the end (a foot, which points where the knee
  // does, whereas captures turn a straight thigh about itself at will).
  MovedLimb(const Actor& actor, int upper, int lower, int end, const Vec3& hinge, int carrier);

  int upper() const { return upper_; }
  int lower() const { return lower_; }
  int end() const { return end_; }

  // The length of both bones in a pose, metres.
  double length(std::span<const Transform> pose) const;

  struct Outcome {
    double correction = 0;  // metres the end was to be moved
    double miss = 0;        // metres by which it was not
    double bend = 0;        // radians by which the middle joint is bent more than before
  };

  // Moves the end by `correction` (world, metres) by two-bone inverse kinematics; the limb keeps
  // the plane it bends in. A correction that is no more than rounding leaves the pose as it is.
  // `pose` is joint_to_world, `local` the reference joint_to_parent; both [joints]. `softness` is
  // TwoBoneGoal's, metres, if it is more than the 0.003 of the limb with which it always
  // straightens.
  Outcome move_end(const Vec3& correction, std::span<const Transform> local,
                   std::span<Transform> pose, double softness = 0) const;

  // Turns the upper bone about the limb's root so that the middle joint points at `goal`; the lower
  // bone keeps its orientation.
  void aim_middle(const Vec3& goal, std::span<const Transform> local,
                  std::span<Transform> pose) const;

  // Turns the lower bone about the middle joint so that `point` (world) points at `goal`; the end
  // keeps its orientation, so `point` moves on by that.
  void aim_end(const Vec3& point, const Vec3& goal, std::span<const Transform> local,
               std::span<Transform> pose) const;

 private:
  enum class Follows : unsigned char { upper, lower, end };
  struct Link {
    int joint = -1;
    int parent = -1;
    Follows follows = Follows::upper;
  };

  void turn(const Quat& upper, const Quat& lower, std::span<const Transform> local,
            std::span<Transform> pose) const;

  int upper_, lower_, end_, carrier_;
  Vec3 hinge_;               // in the carrier's frame
  std::vector<Link> links_;  // the limb's joints, parents first, starting with upper_
};

}  // namespace krok::retarget
