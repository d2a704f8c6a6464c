#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "capture/conventions.h"

namespace krok::bvh {

// BVH has no place for the unit of length. What this project writes has it in blanks after the
// Frame Time, which readers skip: a tab, a space, the unit in three blanks (a tab is a one) and a
// tab.

// Empty for units without a mark: all but m, dm, cm, mm, in, ft and cmu.
std::string unit_mark(double metres);

// `rest` is what follows the Frame Time on its line; nullopt if it is no mark.
std::optional<Unit> marked_unit(std::string_view rest);

}  // namespace krok::bvh
