#pragma once

#include <string>
#include <vector>

#include "draw/plot.h"

// Private to this folder: names beside samples of how they are drawn.

namespace krok::draw {

// What a panel's named series look like.
std::vector<LegendEntry> legend_of(const Panel& panel);

// Lays the names out in rows of `width` pixels; returns the height. `out` null: only measures.
double write_legend(const std::vector<LegendEntry>& entries, double left, double top, double width,
                    std::string* out);

}  // namespace krok::draw
