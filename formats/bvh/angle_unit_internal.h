#pragma once

#include <optional>
#include <string>

#include "formats/bvh/hierarchy.h"
#include "formats/bvh/position_choice.h"

namespace krok::bvh {

// Returns the reason if rotation values look like radians: many joints rotate, yet no value exceeds
// 2 pi, which in degrees (the unit of BVH) would be almost no motion.
std::optional<std::string> looks_like_radians(const Hierarchy& hierarchy, const SampleRows& rows);

}  // namespace krok::bvh
