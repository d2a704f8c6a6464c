#pragma once

#include <string>

#include "draw/plot.h"
#include "scene/clip.h"
#include "tools/krok-ik/outcome.h"

namespace krok::cli::ik {

// By how much each goal is missed over time, in lengths and in angles, as far as there are such
// goals; the joints whose limits hold a goal back, where any does; and, with limits, by how much
// the joint that is farthest beyond its limits is beyond them, in the input and in the result.
// Lengths are millimetres, angles degrees.
draw::Chart chart_of(const Outcome& outcome, const Clip& given, const std::string& title);

}  // namespace krok::cli::ik
