#pragma once

#include <string>

#include "core/result.h"
#include "draw/plot.h"
#include "draw/plot_line_internal.h"

// Private to this folder: heatmaps.

namespace krok::draw {

// Code plot-shape.
Status check_field(const Field& field);

// The colour scale of a field: equal steps from `low` to `high`.
struct FieldScale {
  double low = 0, high = 1;
  int steps = 1;
};
FieldScale scale_of(const Field& field);

// The colour of a value as "#rrggbb": white for the step that contains zero.
std::string field_colour(double value, const FieldScale& scale);

// Writes the cells as rectangles; neighbours of the same colour are merged.
void write_field(const Field& field, const PlotArea& area, std::string& out);

// Writes a colour bar with the values at its ends; `right` and `bottom` are its edges in pixels.
// Returns its left edge.
double write_field_bar(const Field& field, double right, double bottom, std::string& out);

}  // namespace krok::draw
