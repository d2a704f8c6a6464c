#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "contacts/contacts.h"
#include "contacts/gait_keytimes.h"
#include "contacts/gait_seeds_internal.h"

// The feet of a figure on its way: their to and fro about the pelvis, and their stances.

namespace krok::contacts {

struct Foot {
  Seeds seeds;
  std::vector<Stance> stances;
  std::vector<std::size_t> tracks;  // of FoundContacts
  double cycle = kUsualCycle;
};

class WalkingFeet {
 public:
  WalkingFeet(const Clip& clip, const RoleMap& roles, const FoundContacts& found,
              const GaitOptions& options);

  const Foot& foot(std::size_t side) const { return feet_[side]; }
  bool jittery() const { return jittery_; }

  // Whether the foot is down for most of the way from a front seed to the next back seed, or from a
  // back seed to the front seed before. A foot on a pedal is not.
  bool stays_low(const Foot& foot, double seed, bool front) const;
  bool has_tip(const Foot& foot) const;
  // Whether the foot rolls off over its toes at a back seed: the figure walks forward on level
  // ground, and lifts the heel first. It then leaves when its toes are furthest behind the pelvis,
  // at toes_back(); up stairs and in a run it leaves earlier. A figure runs whose pelvis is lowest
  // over the standing foot (in walking it is highest there: Cavagna, Heglund and Taylor 1977), or
  // that is faster than people walk where the pelvis tells nothing.
  bool rolls_off(const Foot& foot, double seed) const;
  double toes_back(const Foot& foot, double seed) const;
  // Whether the points of the foot are elsewhere at one moment than at another.
  bool moves(const Foot& foot, double from, double to) const;
  bool upright(double time) const;

 private:
  // Which way the figure goes in each frame, or faces where it goes too slowly.
  void take_directions();
  void prepare(FootSide side);
  // A foot that slides a little throughout its stance, as in runs captured at a low rate, has no
  // contact. Between its front and its back seed it stands where its slowest point is much slower
  // than in the swing.
  void add_sliding(Foot& foot) const;
  double lowest_of(const Foot& foot, std::size_t f) const;
  double toes_reach(const Foot& foot, int frame) const;
  // How much higher the pelvis is over the foot than at the front seed before and at this back
  // seed; 0 where there is no front seed.
  double rise_over(const Foot& foot, double seed) const;
  // What the pelvis does over the standing foot in most steps.
  enum class Carriage : unsigned char { flat, vaults, bounces };
  Carriage carriage() const;
  // Whether the foot comes down, half a cycle after its back seed, as high as it was half a cycle
  // before.
  bool stays_level(const Foot& foot, double seed) const;
  // Whether the heel is up at a back seed, over where it was against the toes in mid-stance.
  bool is_pitched(const Foot& foot, double seed) const;
  std::size_t frame_at(double time) const;
  // A foot that is where it was at the clip's first frame, or is at its last, has been there.
  void open_ends(Foot& foot) const;
  // The lowest that any foot comes within a cycle of a frame.
  double floor_near(int frame, double cycle) const;
  bool is_low(const Foot& foot, int frame, double floor) const;
  std::optional<Stance> sliding(const Foot& foot, double front, double back) const;
  // A foot that rolls over its heel or its toes touches the ground, though no point of it is still:
  // the place of the heel on the foot is not known well enough, and toes that are not captured do
  // not stay. First and last touch are where a point that comes to stay, or stayed, is slower than
  // anything in a swing.
  void to_touches(const Foot& foot, double before, double after, Stance& stance) const;
  double touch(std::size_t t, double from, double limit, bool first) const;
  // When, in frames, a heel is stopped that is slow from about a frame on. Where it comes to rest,
  // at `rest`, after slowing throughout, that is it. Mostly its place on the foot is not quite
  // right, and it drifts while the foot rolls over the true one: then it is where its slowing falls
  // to half of the most, for what smooths a capture spreads the stop evenly to both sides.
  double end_of_slowing(std::size_t t, int frame, int earliest, double rest) const;
  // Whether the foot is lifted or carried between two moments.
  bool is_step(const Foot& foot, double from, double to) const;

  const Clip& clip_;
  const FoundContacts& found_;
  const GaitOptions& options_;
  double leg_;
  int carrier_ = 0;
  bool jittery_ = false;
  std::vector<Vec3> pelvis_, directions_;
  std::vector<double> speeds_;  // of travel, metres a second
  Carriage carriage_ = Carriage::flat;
  std::vector<std::uint8_t> forward_;  // whether a frame's direction is where the figure faces
  std::vector<std::vector<Vec3>> raw_, tracks_;
  std::vector<double> jitters_;  // metres, of raw_
  std::array<Foot, 2> feet_;
};

}  // namespace krok::contacts
