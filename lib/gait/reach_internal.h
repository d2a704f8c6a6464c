#pragma once

#include "gait/ground_prints_internal.h"

// What a person can do in one step. Used by walk().

namespace krok::gait {

// A step as a library measures it, relative to the stance foot: metres and radians. `toe_out` is
// what its feet turn out by: prints may have any.
struct StepShape {
  double along = 0, across = 0, up = 0;  // across: to the side of the swing foot
  double turn = 0;                       // of the toes, to that side
  double path_turn = 0;                  // of the body
};
StepShape shape_of(const GroundedPrint& stance, const GroundedPrint& to, double toe_out);

// Refuses what no one can step. `number`: of the print that is stepped to, from 0. Codes
// walk-too-long, walk-too-high, walk-crossing, walk-heading, walk-wall.
Status check_reach(const GroundedPrint& from, const GroundedPrint& stance, const GroundedPrint& to,
                   int number, const Walker& walker, const Terrain& ground);

}  // namespace krok::gait
