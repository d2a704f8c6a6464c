#pragma once

#include <optional>
#include <span>
#include <vector>

#include "retarget/pose_alignment.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Feet where the source's are.
//
// The heel's goal is the source's, scaled, on the floor; while the source's foot is rolled over its
// ball, the ball is placed so instead. The ankle's goal follows from it, so a foot that stands
// stands still whatever the height of the ankle and the length of the foot. Then the foot is lifted
// where one of its joints would be deeper in the floor than the source's. Two-bone inverse
// kinematics brings the ankle there as far as the foot stands, knees keep the plane they bend in,
// feet their orientation. Where legs are too short for it, the hips come down beforehand.

namespace krok::retarget {

// The floor under a figure.
struct Floor {
  double sole = 0;    // how deep it lies below the lowest joint of a foot that stands
  double motion = 0;  // its height under the motion
};

// The height of the lowest joint of a foot in a pose, end sites included. The figure must have the
// foot.
double lowest_of_foot(const Actor& actor, Role foot);

// The height of the ankle over the floor in a pose in which the foot stands.
double ankle_over_floor(const Actor& actor, Role foot, const Floor& floor);

// The height that the lowest joints of the feet stand at in a motion: of all frames' lowest ones,
// each against its height in the foot as it stands in `stance`, the twentieth from below in a
// hundred. 0 for a clip without frames.
double standing_height(const Clip& clip, const Actor& stance);

// The frames of 0.12 s at `rate` frames a second, at most 256.
int softening_reach(double rate);

// A curve that is nowhere below `values` (within rounding) and has no corners: the largest of the
// `reach` neighbours on both sides, averaged over as many.
std::vector<double> softened(const std::vector<double>& values, int reach);

// One leg of both figures.
class LegPlacement {
 public:
  // `turns` is the alignment of the target's reference pose, `scale` lengths of the target over
  // those of the source. Nothing where a figure lacks a joint of this leg.
  static std::optional<LegPlacement> create(const Actor& source, const Actor& target,
                                            std::span<const Quat> turns, double scale,
                                            const Floor& source_floor, const Floor& target_floor,
                                            bool is_left);

  struct Outcome {
    double correction = 0;  // metres that the ankle was moved
    double miss = 0;        // metres between the ankle and its goal
  };

  // How much the foot stands in each frame of the source, 0 to 1: by its height and its speed, with
  // slow beginnings and ends; less for a shank that lies, as in kneeling.
  std::vector<double> standing(const Clip& source) const;

  // By how much the hips must come down for the leg to reach its goal; 0 where it does.
  double lack(std::span<const Transform> source_pose, std::span<const Transform> target_pose,
              double standing) const;

  // Moves the leg of a pose of the target to where the source's foot is in `source_pose`, as far as
  // it is `standing`. Both are joint_to_world, shape [joints]; `local` is the target's reference
  // joint_to_parent.
  Outcome place(std::span<const Transform> source_pose, std::span<const Transform> local,
                double standing, std::span<Transform> target_pose) const;

 private:
  LegPlacement() = default;

  // A joint of a foot and its height over the floor in the reference pose.
  struct Point {
    int joint = -1;
    double height = 0;
  };
  static std::vector<Point> points_of_foot(const Actor& actor, int ankle, double floor);

  // A point of the sole on the floor below, as seen from the ankles in their frames.
  struct Sole {
    Vec3 source = Vec3::Zero();
    Vec3 target = Vec3::Zero();
    double longer = 0;  // how much further ahead the target's is than the source's, scaled
  };
  void find_soles(const Actor& source, const Actor& target, const Quat& turn, Role foot);

  Vec3 goal_of(std::span<const Transform> source_pose, std::span<const Transform> target_pose,
               double standing) const;
  double depth(std::span<const Transform> pose, const std::vector<Point>& points,
               double floor) const;

  double scale_ = 1;
  Floor source_floor_, target_floor_;
  double leg_ = 0;  // metres, of the source's thigh and shank
  int source_knee_ = -1, source_ankle_ = -1;
  int source_front_ = -1;  // toes, or the end of the foot, or -1
  int upper_ = -1, lower_ = -1, ankle_ = -1;
  Sole heel_, ball_;
  Vec3 ahead_ = Vec3::Zero();     // the source's foot's heading, in the frame of its ankle
  Vec3 sideways_ = Vec3::Zero();  // to the left of it, likewise
  Vec3 hinge_ = Vec3::Zero();     // of the knee, in the frame of upper_
  std::vector<Point> source_points_, target_points_;

  enum class Follows : unsigned char { thigh, shank, foot };
  struct Link {
    int joint = -1;
    int parent = -1;
    Follows follows = Follows::thigh;
  };
  std::vector<Link> links_;  // the leg's joints, parents first, upper_ the first of them
};

}  // namespace krok::retarget
