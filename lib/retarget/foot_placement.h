#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "retarget/foot_bend.h"
#include "retarget/moved_limb.h"
#include "retarget/pose_alignment.h"
#include "retarget/touches.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Foot planting: places the target's feet where the source's are.
//
// The heel's goal is the source's heel, scaled, on the floor; while the source's foot is rolled
// over its ball, the ball is placed instead: the joint of the toes, which lie on the floor, where
// both have one. The ankle's goal follows from it, so a planted foot stays still whatever the
// height of the ankle and the length of the foot. Where hips are far wider or narrower for their
// legs than the source's, each foot stands as far to the side of its hip as the source's: its
// places are moved across the hips, by the same in all of a stance. Where a point of the foot would
// be deeper in the floor than the source's, toes and foot are bent upwards, and the foot is raised
// by what is left. Two-bone inverse kinematics moves the ankle there, weighted by the foot's
// stance; knees keep the plane they bend in, feet their orientation. A leg that needs no correction
// beyond rounding is left as it is. If legs are too short for their goals, the hips are lowered
// beforehand.

namespace krok::retarget {

class ShiftSolver;

// The floor under a character.
struct Floor {
  double sole = 0;    // depth below the lowest joint of a planted foot
  double motion = 0;  // height in the world of the motion
};

// The height of the lowest joint of a foot in a pose, end sites included. The actor must have the
// foot.
double lowest_of_foot(const Actor& actor, Role foot);

// The height of the ankle above the floor in a pose in which the foot is planted.
double ankle_over_floor(const Actor& actor, Role foot, const Floor& floor);

// The height of the lowest joint of either foot in each frame, measured from its height within the
// foot in a stance.
using LowestOfFeet = std::array<std::vector<float>, 2>;
void add_lowest(const Clip& clip, const Actor& stance, LowestOfFeet& lowest);

// The heights of the feet in stance over a motion: the 20th percentile of the lower one's, and of
// each. 0 without frames.
struct StandingHeight {
  double lower = 0;
  std::array<double, 2> of_foot = {0, 0};
};
StandingHeight standing_height(LowestOfFeet lowest);

// The stance of a foot in a frame, as it is kept for all frames of a take. Both from 0 to 1.
struct KeptStance {
  double standing = 0;  // how far its place is kept
  double on_ball = 0;   // whether the ball is placed, or the heel (0)
  // Metres along X and Z from the source's place, scaled, for the width of the hips.
  std::array<float, 2> beside = {0, 0};
};

struct FootStance : KeptStance {
  BendAngles bend = {};
};

// One leg of source and target.
class LegPlacement {
 public:
  // `turns` aligns the target's reference pose, `scale` is lengths of the target over those of the
  // source. `heel` is the heel of the source's foot in the ankle's frame, metres, for which its
  // contacts are; without it a typical one. `source_points` and `target_points` are points of both
  // feet beside their joints. Empty if either skeleton lacks a joint of this leg.
  static std::optional<LegPlacement> create(const Actor& source, const Actor& target,
                                            std::span<const Quat> turns, double scale,
                                            const Floor& source_floor, const Floor& target_floor,
                                            bool is_left, const std::optional<Vec3>& heel,
                                            std::span<const BodyPoint> source_points,
                                            std::span<const BodyPoint> target_points);

  // The heel of both.
  PointPair heel() const { return {{source_ankle_, heel_.source}, {limb_.end(), heel_.target}}; }

  using Outcome = MovedLimb::Outcome;  // of the ankle

  // Stance weight of the foot in each frame of the source, 0 to 1: in its contacts and while it is
  // near the floor, with soft starts and ends; less if the shank lies, as in kneeling, and none in
  // flight. `bearing` is that of its contacts alone, `touching` is 0 sooner before and
  // after them. `contacts` are those of the source.
  struct Stances {
    std::vector<KeptStance> feet;
    std::vector<double> bearing, touching;
  };

  // What stances are found from, of all frames of a take.
  struct Track {
    std::vector<char> heel, front;             // in contact
    std::vector<double> near, upright, rolls;  // of the frames that were added
    std::vector<double> left, ahead;           // of the ankle placed by the heel, from the ball
    std::vector<Eigen::Vector2f> across;  // X and Z of the line across the hips to this leg, length
                                          // 1 where level; empty where their widths are alike
  };
  Track begin_track(std::span<const Contact> contacts, int frames, double rate) const;
  // The frames [begin, end) of a clip, in order.
  void add(const Clip& source, int begin, int end, Track& track) const;
  // Heel and ball are placed alike from here on where both are in contact, however the foot is
  // pitched there.
  Stances find_stances(Track track, double rate);

  // The angle by which toes and foot of a target pose have to be bent upwards not to be deeper in
  // the floor than the source's, radians.
  double needed_bend(std::span<const Transform> source_pose, std::span<const Transform> target_pose,
                     const FootStance& stance) const;
  // Bends them by FootStance::bend. Before all that follows.
  void bend_foot(const FootStance& stance, std::span<Transform> target_pose) const {
    foot_bend_.bend(stance.bend.toes, stance.bend.foot, target_pose);
  }

  // Adds what the leg needs of the hips to be as bent as the source's.
  void add_lack(std::span<const Transform> source_pose, std::span<const Transform> target_pose,
                const FootStance& stance, double bearing, ShiftSolver& solver) const;

  // From the hip to the goal of the ankle.
  struct Way {
    Vec3 to_goal = Vec3::Zero();
    double reach = 0;  // metres: the present extension, or nearly the full length if that is more
    double standing = 0;

    // By how much the hips must be lowered for the leg to reach its goal, metres; 0 if it does.
    double lack() const;
    // By how much the leg is too short for its goal once the hips are lowered by `drop`, metres.
    double short_by(double drop) const {
      return std::max(0.0, (to_goal + drop * Vec3::UnitY()).norm() - reach);
    }
  };
  Way way(std::span<const Transform> source_pose, std::span<const Transform> target_pose,
          const FootStance& stance) const;

  // Moves the leg of a target pose to where the source's foot is in `source_pose`, as far as it
  // stands; only a `part` of that way where the leg kneels (0: wholly). `softness` is that of
  // MovedLimb::move_end(). Both poses are joint_to_world, shape [joints]; `local` is the target's
  // reference joint_to_parent.
  Outcome place(std::span<const Transform> source_pose, std::span<const Transform> local,
                const FootStance& stance, double part, double softness,
                std::span<Transform> target_pose) const;

  // How much deeper in the floor a point of the target's foot is than any of the source's, scaled,
  // and its joint; 0 and -1 if none is.
  struct Sunk {
    double depth = 0;  // metres
    int joint = -1;
  };
  Sunk sunk(std::span<const Transform> source_pose, std::span<const Transform> target_pose) const;

 private:
  explicit LegPlacement(MovedLimb limb) : limb_(std::move(limb)) {}

  static std::vector<FootPoint> points_of_foot(const Actor& actor, int ankle, double floor,
                                               std::span<const BodyPoint> more);

  // A point that a foot turns about as it rolls, in the frames of both ankles.
  struct Sole {
    Vec3 source = Vec3::Zero();
    Vec3 target = Vec3::Zero();
    // Where the target's is from the scaled source's while the foot is flat: to the left, up,
    // ahead.
    Vec3 apart = Vec3::Zero();
  };
  void find_soles(const Actor& source, const Actor& target, const Quat& turn, Role foot,
                  const std::optional<Vec3>& heel);

  // Where the ankle is to be; before the foot is raised for the floor.
  Vec3 goal_of(std::span<const Transform> source_pose, std::span<const Transform> target_pose,
               const FootStance& stance) const;
  Vec3 place_of(std::span<const Transform> source_pose, std::span<const Transform> target_pose,
                const FootStance& stance) const;
  // The height that a point of the target's foot may have over the floor, 0 or below.
  double allowed(std::span<const Transform> source_pose) const;
  Vec3 heading_of(const Quat& source_ankle) const;

  MovedLimb limb_;
  double scale_ = 1;
  Floor source_floor_, target_floor_;
  double leg_ = 0;     // metres, of the source's thigh and shank
  double beside_ = 0;  // metres of FootStance::beside, away from the other leg
  int source_hip_ = -1, source_other_hip_ = -1;
  int source_knee_ = -1, source_ankle_ = -1;
  int source_front_ = -1;  // toes, or the end site of the foot, or -1
  Sole heel_, ball_;
  Quat onto_target_ = Quat::Identity();  // from the source's ankle's frame to the target's
  Vec3 ahead_ = Vec3::Zero();            // heading of the source's foot, in its ankle's frame
  Vec3 sideways_ = Vec3::Zero();         // left of ahead_, in the same frame
  std::vector<FootPoint> source_points_, target_points_;
  std::size_t source_joints_ = 0;  // the first of source_points_
  FootBend foot_bend_;
};

}  // namespace krok::retarget
