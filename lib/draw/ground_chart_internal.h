#pragma once

#include <span>

#include "draw/motion_charts.h"

// Private to this folder: a ground seen from above.

namespace krok::draw {

// The footprints, as soles with their numbers.
void add_prints(const ChartedGround& ground, Panel& panel);

// Heights of the ground within the panel's limits, as a field and contour lines; nothing if it is
// level. They are those below the motions' highest joints.
void add_heights(std::span<const ChartedMotion> motions, const ChartedGround& ground, Panel& panel);

}  // namespace krok::draw
