#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/result.h"
#include "gait/path.h"
#include "gait/print.h"
#include "gait/step_library.h"
#include "terrain/terrain.h"

// Footprints along a path.

namespace krok::gait {

struct PlanOptions {
  double step_length = 0.65;  // metres along the path, where it is straight; > 0
  // Instead of that: at places evenly spaced over the path, from its begin to its end, and linear
  // in between. Empty: step_length everywhere.
  std::vector<double> step_lengths;
  double min_step = 0.15;           // metres; > 0
  double max_step = 0.8;            // metres, at least step_length
  double step_width = 0.2;          // metres from heel to heel across the path
  double max_turn = 0.45;           // radians a step, > 0: in curves steps are shorter
  double max_rise = 0.25;           // metres a step up or down
  bool backward = false;            // the character faces where it comes from
  FootSide first = FootSide::left;  // the foot that steps first
  std::array<double, 2> toe_out{};  // [FootSide], radians added to the heading, positive to +X
  // The sole from heel to toes; edges of the ground are kept from under it.
  double heel_to_ball = 0.16, heel_to_toes = 0.24, sole_width = 0.08;  // metres
};

struct PlannedPrints {
  std::vector<Print> prints;
  // Whether the ground made steps uneven, because feet would have stood on edges or steps would
  // have been too high.
  bool fitted_to_ground = false;
};

// Prints left and right of a path: the first two side by side at its begin, the last two at its
// end, and between them steps of equal length on straight ways, equally shorter in curves and
// downhill, so many that their length is nearest to what is asked for. Where a sole would lie
// across an edge of the ground or a step would rise more than asked for, prints are set along the
// path so that each sole lies on one surface (heel and ball at least; toes may stand out over a
// lower edge; or ball and midfoot, where the heel does: such prints have a height) and steps remain
// between the least and the most, as even as can be. A path with times gives prints with times.
//
// Codes: plan-options for options out of range; plan-ground if there is no ground at the begin, or
// no place for a foot that a step could reach, with the place where it ends.
Result<PlannedPrints> plan_prints(const Path& path, const Terrain& ground,
                                  const PlanOptions& options);

// Options for planning prints as the steps of the libraries are, over their examples: length, width
// and toe-out are the means of the first library, taken of the straight examples on level ground if
// there are any, in captures that mostly go straight on if there are any; the most in length and
// turn are the most of all of them. The sole is that of the first library's left foot. A library of
// steps backward plans a walk backward. Codes: walk-legs; walk-library if the steps go neither
// forward nor backward.
Result<PlanOptions> usual_steps(std::span<const StepLibrary> libraries);

// Metres of the steps that go at `speed` (m/s, > 0) in the libraries of walks and runs: steps last
// as long as those of examples about as long do. Between a walk and a run, where no example goes at
// that speed, those of the nearest. Code walk-speed if it is more than 5 % beyond all of them.
Result<double> step_length_at_speed(std::span<const StepLibrary> libraries, double speed);

}  // namespace krok::gait
