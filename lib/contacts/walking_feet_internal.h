#pragma once

#include <array>
#include <optional>
#include <vector>

#include "contacts/contacts.h"
#include "contacts/event_pairing_internal.h"
#include "contacts/gait_keytimes.h"

// The feet of a walking character: turning points relative to the pelvis, and stances.

namespace krok::contacts {

struct Foot {
  Seeds seeds;
  std::vector<Stance> stances;
  std::vector<std::size_t> tracks;  // indices into FoundContacts::tracks
  double cycle = kUsualCycle;
};

class WalkingFeet {
 public:
  WalkingFeet(const Clip& clip, const RoleMap& roles, const FoundContacts& found,
              const GaitOptions& options);

  const Foot& foot(std::size_t side) const { return feet_[side]; }
  bool jittery() const { return jittery_; }
  double jitter() const;  // metres, frame to frame, of the point that jitters most

  // Whether the foot is down for most of the time from a front seed to the next back seed, or from
  // a back seed to the front seed before. A foot on a pedal is not.
  bool stays_low(const Foot& foot, double seed, bool front) const;
  bool has_tip(const Foot& foot) const;
  // Whether the foot rolls off over its toes at a back seed: the character walks forward on level
  // ground, and lifts the heel first. Toe-off is then when the toes are furthest behind the pelvis,
  // at toes_back(); when climbing stairs and in a run it is earlier. A character runs if its pelvis
  // is lowest over the standing foot (in walking it is highest there: Cavagna, Heglund and Taylor
  // 1977), or, if the pelvis is inconclusive, if it is faster than people walk.
  bool rolls_off(const Foot& foot, double seed) const;
  bool runs(double time) const;
  double toes_back(const Foot& foot, double seed) const;
  // Whether the positions of the foot's points at two times differ.
  bool moves(const Foot& foot, double from, double to) const;
  bool upright(double time) const;

 private:
  // The direction of travel in each frame; the facing direction at low speed.
  void take_directions();
  void prepare(FootSide side);
  // A foot that slides a little throughout its stance, as in runs captured at a low rate, has no
  // contact. It is in stance between its front and its back seed where its slowest point is much
  // slower than in swing.
  void add_sliding(Foot& foot) const;
  double lowest_of(const Foot& foot, std::size_t f) const;
  double slowest_of(const Foot& foot, int frame) const;  // speed of its slowest point
  double toes_reach(const Foot& foot, int frame) const;
  // Height of the pelvis half-way between the last front seed and this back seed, above its mean
  // height at both; 0 without a front seed.
  double rise_over(const Foot& foot, double seed) const;
  // The motion of the pelvis over the standing foot in most steps.
  enum class Carriage : unsigned char { flat, vaults, bounces };
  void find_carriage();
  Carriage carriage(double time) const;
  // Whether the foot half a cycle after its back seed is about as high as 0.3 cycles before it.
  bool stays_level(const Foot& foot, double seed) const;
  // Whether the heel at a back seed is raised relative to the toes, compared with mid-stance.
  bool is_pitched(const Foot& foot, double seed) const;
  std::size_t frame_at(double time) const;
  // Extends stances to the clip's first and last frame if the foot hardly moves up to there.
  void open_ends(Foot& foot) const;
  // The lowest height of both feet within a cycle of a frame.
  double floor_near(int frame, double cycle) const;
  bool is_low(const Foot& foot, int frame, double floor) const;
  std::optional<Stance> sliding(const Foot& foot, double front, double back) const;
  // Extends a stance to the first and last touch. A foot that rolls over its heel or its toes
  // touches the ground although no point of it is still: the position of the heel on the foot is
  // not known well enough, and toes that are not captured do not stay. The touches are where a
  // point, before or after its contact, is slower than anything in a swing.
  void to_touches(const Foot& foot, double before, double after, Stance& stance) const;
  // In a run, extends stances to where the foot has nearly stopped and where it has hardly left: it
  // lands at a metre per second within a frame or two, so that contacts begin late and end early.
  void to_landings(Foot& foot) const;
  double touch(std::size_t t, double from, double limit, bool first) const;
  // The fractional frame at which a heel that is slow around `frame` is stopped. If it comes to
  // rest, at `rest`, after slowing throughout, it is that. Mostly its position on the foot is
  // slightly wrong, and it drifts while the foot rolls over the true one: then it is where its
  // deceleration falls to half the peak, because smoothing of the capture spreads the stop evenly
  // to both sides.
  double end_of_slowing(std::size_t t, int frame, int earliest, double rest) const;
  // Whether the foot is lifted or moved between two times.
  bool is_step(const Foot& foot, double from, double to) const;

  const Clip& clip_;
  const FoundContacts& found_;
  const GaitOptions& options_;
  double leg_;
  int carrier_ = 0;
  bool jittery_ = false;
  std::vector<Vec3> pelvis_, directions_;
  std::vector<double> speeds_;  // of travel, metres per second
  struct Rise {
    double time;  // seconds, of a step
    int up;       // 1 where the pelvis rises over it, -1 where it sinks
  };
  std::vector<Rise> rises_;
  std::vector<int>
      forward_;  // [frames] 1: the pelvis travels to where the character faces, -1: backwards
  std::vector<std::vector<Vec3>> raw_, tracks_;
  std::vector<double> jitters_;  // metres, of raw_
  std::array<Foot, 2> feet_;
};

}  // namespace krok::contacts
