#pragma once

#include <optional>
#include <string>

#include "formats/bvh/hierarchy.h"
#include "formats/bvh/position_choice.h"

namespace krok::bvh {

// Why the angles of some rows look like radians, where they do: BVH has degrees, but where many
// joints turn and no value is beyond a whole turn in radians, the figure would hardly move.
std::optional<std::string> looks_like_radians(const Hierarchy& hierarchy, const SampleRows& rows);

}  // namespace krok::bvh
