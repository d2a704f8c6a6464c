#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "contacts/legs.h"
#include "gait/step_library.h"
#include "math/transform.h"
#include "parametric/packed_examples.h"
#include "scene/skeleton.h"

// A pose is one vector: joint_to_parent of each joint of the libraries' packed skeleton (rooted at
// the hips), position x, y, z and quaternion x, y, z, w; the root's is joint_to_world. Corrections
// are added to it, quaternions too, and normalised afterwards, so that sums of curves with two
// continuous derivatives have them as well.

namespace krok::gait {

using PoseVector = Eigen::VectorXd;
inline constexpr Eigen::Index kPoseValues = 7;  // a joint

inline auto position_of(const PoseVector& pose, int joint) {
  return pose.segment<3>(kPoseValues * joint);
}
inline auto position_of(PoseVector& pose, int joint) {
  return pose.segment<3>(kPoseValues * joint);
}
inline auto rotation_of(const PoseVector& pose, int joint) {
  return pose.segment<4>(kPoseValues * joint + 3);
}
inline auto rotation_of(PoseVector& pose, int joint) {
  return pose.segment<4>(kPoseValues * joint + 3);
}
Transform joint_of(const PoseVector& pose, int joint);  // rotation normalised

Transform joint_to_world(const Skeleton& skeleton, const PoseVector& pose, int joint);

// The mean of a library's examples: what its steps have in common.

PoseVector mean_pose(const parametric::PackedExamples& packed, double generic);

// When the stance foot is flat: in a walk, of the time from the swing foot's off to its strike; in
// a run, of that from the stance foot's strike to its off.
inline constexpr double kFlatPart = 0.4, kFlatInRun = 0.45;

// The time at which the stance foot is flat, by those of the keytimes (generic, or of an example).
double middle_of_stance(std::span<const double> times, const parametric::Library& library);

// The number of the keytimes where there is none of that name.
std::size_t index_of_time(const parametric::Library& library, const char* name);

// The body that walks: what is the same in all its steps.

constexpr std::size_t index_of(FootSide side) {
  return static_cast<std::size_t>(side);
}
constexpr FootSide other(FootSide side) {
  return side == FootSide::left ? FootSide::right : FootSide::left;
}

// A foot, in the frame of its joint (the ankle).
struct FootGeometry {
  Vec3 heel = Vec3::Zero(), ball = Vec3::Zero();  // of the sole
  // What the foot turns about when the heel is up: the toes' joint, or the ball.
  Vec3 pivot = Vec3::Zero();
  Quat sole = Quat::Identity();  // sole_to_foot: x to the left, y up, z from heel to ball
  double length = 0;             // metres, heel to ball; 0: the ball is not known
  double tip = 0;                // metres from the ball to the tip of the toes
  // Heels are round, so that a foot with its toes up rolls over them: the radius, metres. `heel` is
  // the corner that a sharp one would have.
  double heel_radius = 0;

  // In the frame of the foot: the middle of that circle.
  Vec3 heel_middle() const { return heel + sole * Vec3(0, heel_radius, heel_radius); }
};

struct Leg : LegJoints {
  std::vector<int> path;           // joints from the thigh to the toes, or the foot
  Vec3 knee_axis = Vec3::UnitX();  // cross(thigh, shank), in the thigh's frame
  double length = 0;               // metres, thigh and shank
  FootGeometry sole;
  Quat flat_toes = Quat::Identity();  // sole_to_toes: of the toes while the foot is flat
  double standing_ankle = 0;          // ankle_angle() in the standing pose
};

// Radians between shank and sole.
double ankle_angle(const Leg& leg, std::span<const Transform> joint_to_world);

// A joint that stays where it is in its parent.
struct FixedJoint {
  int joint = -1;
  Vec3 place = Vec3::Zero();  // in its parent
};

struct Walker {
  const Skeleton* skeleton = nullptr;  // of the poses
  std::array<Leg, 2> legs;             // [FootSide]
  PoseVector stand;                    // the root relative to the point below the ankles, facing +Z
  std::vector<FixedJoint> bones;       // all but the root and what moves in captures
  int spine = -1, neck = -1;           // the joints that the trunk and the head turn about
  double sole_width = 0.08;            // metres
  // When the ball leaves the ground, as a share of the time from the other foot's strike to this
  // foot's toe-off, from captures: the toes stay on the ground longer.
  double ball_off = 1;
  double usual_off = 0.1;  // seconds from that strike to toe-off, in the mean step
  bool runs = false;       // whether there is a library of runs
  double run_off = 1;      // when the ball leaves the ground in a run, of the time to stance_off

  const Leg& leg(FootSide side) const { return legs[index_of(side)]; }
  // joint_to_world of all joints.
  void to_world(const PoseVector& pose, std::span<Transform> joint_to_world) const;
};

// Code walk-legs if the skeleton has no legs of thigh, shank and foot. The standing pose is from a
// library of stands, starts or stops if there is one.
Result<Walker> make_walker(std::span<const StepLibrary> libraries);

}  // namespace krok::gait
