#pragma once

#include "gait/print.h"
#include "gait/walker_internal.h"
#include "terrain/terrain.h"

// Footprints set on the ground.

namespace krok::gait {

// The height of what a walker who stands at `from` metres steps on at (x, z): not what is overhead.
std::optional<GroundPoint> ground_near(const Terrain& ground, double x, double z, double from,
                                       double leg_length);

// Where a print (number `number`, from 0) lies. `from` is the height of the print before. Codes
// walk-ground (a hole, beyond the edge) and walk-too-steep.
Result<GroundedPrint> set_on_ground(const Print& print, int number, const Walker& walker,
                                    const Terrain& ground, double from);

// Limits of what a person can do in one step.

// A step as a library measures it, relative to the stance foot: metres and radians. `toe_out` is
// how far the library's feet turn out; prints may have any toe-out.
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
