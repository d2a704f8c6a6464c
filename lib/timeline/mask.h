#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "scene/skeleton.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// How much each joint is moved, 0 to 1, shape [joints]. Code timeline-mask, with the rule's place:
// a name or pattern that no joint has, a weight outside 0 to 1, a soft edge that is negative.
Result<std::vector<double>> mask_weights(const Skeleton& skeleton, std::span<const MaskRule> rules);

}  // namespace krok::timeline
