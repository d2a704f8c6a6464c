#pragma once

#include <string>
#include <vector>

#include "draw/plot.h"

// Private to this folder: legends.

namespace krok::draw {

// Legend entries of the panel's named series.
std::vector<LegendEntry> legend_of(const Panel& panel);

// Lays the entries out in rows of `width` pixels; returns the height. If `out` is null, only
// measures.
double write_legend(const std::vector<LegendEntry>& entries, double left, double top, double width,
                    std::string* out);

}  // namespace krok::draw
