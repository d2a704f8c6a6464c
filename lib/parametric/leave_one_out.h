#pragma once

#include <vector>

#include "parametric/library.h"
#include "rbf/weight_solver.h"

namespace krok::parametric {

// How near a library without one of its examples comes to that example: the distance of all joints
// over the motion, root mean square (metres), each motion seen from its own stance foot and
// compared at the same part between the same keytimes.
struct HeldOut {
  int example = 0;
  double weighted = 0;  // by the weight function of the others
  double linear = 0;    // by its plane alone: the least-squares fit to the others' weights
  double nearest = 0;  // by the other example whose parameters, scaled by their ranges, are nearest
  bool inside = false;  // whether its parameters lie between the others'
  bool failed = false;  // whether the others make no motion there; the distances are then 0
};

// Each example left out in turn. `kernel` is that of the weight functions; nothing is refined.
// Codes: those of check(Library) and of WeightSolver::create() for all examples together.
Result<std::vector<HeldOut>> leave_one_out(const Library& library, rbf::Kernel kernel);

}  // namespace krok::parametric
