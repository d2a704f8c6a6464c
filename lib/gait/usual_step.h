#pragma once

#include <span>

#include "gait/plan_prints.h"
#include "gait/step_library.h"

namespace krok::gait {

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
