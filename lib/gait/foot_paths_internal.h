#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "gait/body_motion_internal.h"

// Paths of the feet: fixed on their prints while they roll over heel and ball as in the blend, and
// clear of the ground in between.

namespace krok::gait {

// A foot in the world.
struct FootPose {
  Transform foot;
  Quat toes = Quat::Identity();  // of the toes' joint
};

// The frames of a step.
struct SampledStep {
  int first = 0;                                // frame of the walk
  std::vector<PoseVector> poses;                // joined, [frames]
  std::vector<std::array<FootPose, 2>> blend;   // the feet of these poses
  std::vector<std::array<Vec3, 2>> hips;        // the thighs' upper ends in these poses
  std::vector<std::array<FootPose, 2>> target;  // where they shall be
  std::vector<double> lowering;                 // metres that the pelvis needs, [frames]
};

// A foot on a print.
class Stance {
 public:
  Stance() = default;
  // `middle`: the foot of the blend when it is flat.
  Stance(const Leg& leg, const GroundedPrint& print, const FootPose& middle);

  // Radians that the foot of the blend is turned about its ball, toes down, > 0, or its heel, < 0.
  double pitch(const FootPose& blend) const { return deviation(blend).x(); }

  double strike = 0, flat_from = 0, flat_to = 0, off = 0;  // seconds
  // Seconds, when the tip of the toes leaves the print, if it is before the blend's toe-off.
  double tip_off = std::numeric_limits<double>::infinity();
  FootPose at(double time, const FootPose& blend) const;
  // When the ball comes to rest: with the heel, unless it strikes first.
  double ball_from() const { return gait_.forefoot >= 1 ? strike : flat_from; }

  // `foot` turned by radians more about its ball, toes down.
  FootPose rolled(FootPose foot, double angle) const;
  // From `from` on, where the heel rises, rolls over the ball further than the blend: by `angle` at
  // toe-off. `from` is at least flat_from and becomes flat_to if that is later.
  void roll_further(double angle, double from);
  // Flat from 30 ms after `time` on, when the blend is nearly flat, or from 60 ms after the strike
  // if that is later, but not after `latest`: a foot that is flat at once stops dead, and the swing
  // before throws its toes up to match that.
  void be_flat(double time, double latest);
  // Flat to `time`, or to 60 ms before the off if that is earlier, but not before `earliest` or
  // flat_from: a foot that is flat till it leaves turns at once, and the swing overshoots.
  void leave(double time, double earliest);
  // How the foot strikes, other than in the blend. With `gait.forefoot` its ball is on the ground
  // from the strike on, and its heel comes down until `flat`, which is flat_from if that is
  // earlier.
  void land(const SlopeGait& gait, double flat);

 private:
  Vec3 deviation(const FootPose& blend) const;  // rotation vector in the sole's axes

  const Leg* leg_ = nullptr;
  Transform flat_;  // foot_to_world
  Quat axes_;       // sole_to_world
  Quat middle_;
  Vec3 heel_ = Vec3::Zero(), pivot_ = Vec3::Zero();  // world
  double roll_ = 0, roll_from_ = 0;                  // radians, seconds
  SlopeGait gait_;
};

// The path of a foot from print to print, as an offset from the blend's.
class Swing {
 public:
  // `matching`: seconds after the off, and before the strike, in which the foot takes on the
  // velocity of the blend's.
  Swing(const Leg& leg, double off, double strike, double matching)
      : leg_(&leg), off_(off), strike_(strike), matching_(matching), lifted_(off) {}

  // The foot in the blend and on its print, at toe-off and 1 and 2 `spacing` seconds before, or at
  // the strike and after.
  struct Ends {
    std::array<FootPose, 3> blend, wanted;
    double spacing = 0;
  };
  void set_ends(const Ends& off, const Ends& strike);

  // Until when, `until` at the latest, the tip of the toes stays where it is: as long as it is on
  // the ground and the blend's stays, and the foot need not be drawn far for it. `blend` has its
  // poses at `times` of the swing.
  double tip_stays_until(double until, std::span<const double> times,
                         std::span<const FootPose> blend) const;
  // Keeps the tip where it is until `until`. `blend` has its poses then and 1 and 2 `spacing`
  // before.
  void keep_tip(double until, const std::array<FootPose, 3>& blend, double spacing);

  // Keeps the foot clear of the ground: raises it, and at the edges of stairs holds it back until
  // it is high enough, or moves it on before it comes down. `blend` has its poses at `times` of the
  // swing, `from` is the height of the higher print.
  void clear(const Terrain& ground, std::span<const double> times, std::span<const FootPose> blend,
             double clearance, double from);

  FootPose at(double time, const FootPose& blend) const;
  double lifted() const { return lifted_; }  // seconds, when the tip leaves the ground

  // Whether a foot is so far from both prints, or so near to the middle of the swing, that it is to
  // be clear of the ground in full.
  bool is_to_be_clear(double time, const FootPose& foot) const;

 private:
  using Offset = Eigen::Matrix<double, 11, 1>;  // position, rotation, toes' rotation in the foot
  static Offset offset_of(const FootPose& blend, const FootPose& wanted);
  FootPose free_at(double time, const FootPose& blend) const;  // without tip and detour
  Vec3 to_tip(const FootPose& foot) const;  // along the ground, from its tip to where that stays
  double part_of(double time) const { return (time - off_) / (strike_ - off_); }
  double part_lifted(double time) const { return (time - lifted_) / (strike_ - lifted_); }
  // Offsets that keep the foot clear of the ground: bumps u^a (1 - u)^b over the part u of the
  // swing, all but the lift from when the tip is lifted on.
  struct Detour {
    double lift = 0, hold = 0;  // metres up, and along the swing
    int rise = 3, fall = 3;     // exponents of the lift
    double toes_up = 0;         // radians, about the ankle
    int toes_rise = 3, toes_fall = 3;
  };
  // A point of the sole that is too low by `height` metres, `lever` ahead of the ankle.
  struct Lack {
    double part, lifted, height, lever;  // parts of the swing, and from when the tip is lifted
  };
  // The turn of the foot by which ball and tip lack no more than the heel does, as far as it goes.
  static void raise_toes(std::span<const Lack> missing, Detour& detour);
  double away(const FootPose& foot) const;  // metres from the nearer print, level
  // 0 to 1: how far a foot is from both prints, or in the middle of the swing.
  double between_prints(double part, const FootPose& foot) const;
  // 0 to 1: the share of the clearance that is asked for at a part of the swing.
  double share_of_clearance(double part, const FootPose& foot) const;
  Vec3 detour_at(double time, const Detour& detour) const;
  std::vector<Lack> lacks(const Terrain& ground, std::span<const double> times,
                          std::span<const FootPose> blend, double clearance, double from) const;

  const Leg* leg_;
  double off_, strike_, matching_;
  double lifted_;                  // seconds, when the tip leaves the ground
  Vec3 tip_ = Vec3::Zero();        // where it is until then
  Vec3 up_ = Vec3::UnitY();        // of the ground there
  Vec3 blend_tip_ = Vec3::Zero();  // the blend's at the off
  std::array<Vec3, 3> held_ = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // then, and derivatives
  std::array<Offset, 3> start_ = {}, end_ = {};   // value and two derivatives by time
  Vec3 from_ = Vec3::Zero(), to_ = Vec3::Zero();  // the ankle at both ends
  Vec3 way_ = Vec3::Zero();                       // level, from print to print, unit vector
  Detour detour_;
};

// The points of a sole that touch the ground: heel, ball, tip; world.
std::array<Vec3, 3> sole_points(const Leg& leg, const FootPose& foot);

// The same foot with its quaternions in the hemisphere of `reference`, so that differences of them
// are continuous.
FootPose in_signs_of(const Leg& leg, const Quat& reference, FootPose foot);

FootPose foot_of(const Leg& leg, std::span<const Transform> joint_to_world);

// Legs from where the pelvis and the feet are.

// The longest distance from hip to ankle that a leg is given where the blend's is `blend`: nearly
// straight, or as far as in the blend.
double longest_reach(const Leg& leg, double blend);

// Metres by which the pelvis must be lowered so that no leg is longer than that.
double lowering_for(const Walker& walker, std::span<const Transform> joint_to_world,
                    const std::array<FootPose, 2>& target);

// A curve at or above `needs` (>= 0), without corners, that is no higher than it has to be: bumps
// of `reach` frames on either side are added until nothing is missing.
std::vector<double> smooth_above(std::span<const double> needs, int reach);

struct SolvedLegs {
  double extension = 0;  // largest distance from hip to ankle, of the leg's length
  double missed = 0;     // metres by which a foot does not reach its place
};
// Brings the feet of `pose` to `target`. `joint_to_world`: of the pose; changed with it.
SolvedLegs solve_legs(const Walker& walker, const std::array<FootPose, 2>& target, double stretch,
                      PoseVector& pose, std::span<Transform> joint_to_world);

}  // namespace krok::gait
