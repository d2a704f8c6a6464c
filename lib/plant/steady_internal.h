#pragma once

#include <vector>

#include "plant/legs_internal.h"
#include "plant/smooth_curve_internal.h"

// Jitter of the whole body. Used by plant_feet().

namespace krok::plant {

// Takes the jitter that feet and pelvis share out of everything from the pelvis on. `shifts` bring
// the feet to their places, one a leg. Returns the jitter's root mean square, metres.
double steady(const PlantedBody& body, const std::vector<KnownCurve>& shifts, Clip& clip);

}  // namespace krok::plant
