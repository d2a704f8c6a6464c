#pragma once

#include <span>
#include <vector>

#include "gait/print.h"
#include "gait/walker_internal.h"
#include "terrain/terrain.h"

// Footprints set on the ground. Used by walk().

namespace krok::gait {

// The height of what a walker who stands at `from` metres steps on at (x, z): not what is overhead.
std::optional<GroundPoint> ground_near(const Terrain& ground, double x, double z, double from,
                                       double leg_length);

// Where a print (number `number`, from 0) lies. `from` is the height of the print before. Codes
// walk-ground (a hole, beyond the edge) and walk-too-steep.
Result<GroundedPrint> set_on_ground(const Print& print, int number, const Walker& walker,
                                    const Terrain& ground, double from);

}  // namespace krok::gait
