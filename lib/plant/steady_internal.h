#pragma once

#include <vector>

#include "plant/legs_internal.h"
#include "plant/smooth_curve_internal.h"

// Jitter of the whole body. Used by plant_feet().

namespace krok::plant {

// The deviation of the pelvis' jitter from frame to frame, metres.
double pelvis_jitter(const PlantedBody& body, const Clip& clip);

// Takes the jitter that feet and pelvis share out of everything from the pelvis on. `shifts` bring
// the feet to their places, one a leg; `jitter` is that of the pelvis as captured. Returns the root
// mean square of what was taken out, metres.
double steady(const PlantedBody& body, const std::vector<KnownCurve>& shifts, double jitter,
              Clip& clip);

}  // namespace krok::plant
