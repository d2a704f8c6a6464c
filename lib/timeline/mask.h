#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "scene/skeleton.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// The weight of each joint, 0 to 1, shape [joints]. Code timeline-mask, with the rule's location:
// a name or pattern that matches no joint, a weight outside 0 to 1, a negative soft edge.
Result<std::vector<double>> mask_weights(const Skeleton& skeleton, std::span<const MaskRule> rules);

}  // namespace krok::timeline
