#pragma once

#include <span>
#include <vector>

#include "gait/ground_prints_internal.h"
#include "gait/walk.h"
#include "parametric/blended_motion.h"

// Which step of which library goes from print to print. Used by walk().

namespace krok::gait {

// The step over print `stance`, from print stance - 1 to print stance + 1.
struct PlannedStep {
  int stance = 0;
  int library = 0;
  std::vector<double> asked;    // parameters by the prints
  std::vector<double> nearest;  // the nearest inside the examples' range
  double far = 0;               // metres from `asked` to `nearest`
  std::vector<double> weights;
  std::vector<double> made;  // parameters of the blend
};

struct PlannedWalk {
  std::vector<Print> prints;  // moved where `adapt` asked for it
  std::vector<GroundedPrint> grounded;
  std::vector<PlannedStep> steps;
  std::vector<double> moved;  // metres, [prints]
  std::vector<std::string> why_moved;
  Diagnostics warnings;
};

Result<PlannedWalk> plan_steps(std::span<const StepLibrary> libraries, const Walker& walker,
                               std::span<const Print> prints, const Terrain& ground,
                               const WalkOptions& options);

}  // namespace krok::gait
