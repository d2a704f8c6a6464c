#pragma once

#include <string>

#include "core/result.h"
#include "draw/plot.h"
#include "draw/plot_line_internal.h"

// Private to this folder: fields of values as colours.

namespace krok::draw {

// Code plot-shape.
Status check_field(const Field& field);

// What the colours of a field stand for: from `low` to `high` in even steps.
struct FieldScale {
  double low = 0, high = 1;
  int steps = 1;
};
FieldScale scale_of(const Field& field);

// The colour of a value as "#rrggbb": white for the step that holds zero.
std::string field_colour(double value, const FieldScale& scale);

// The cells as rectangles, neighbours of one colour in one.
void write_field(const Field& field, const PlotArea& area, std::string& out);

// A bar of the colours with the values at its ends, its right end at `right`, standing on `bottom`
// (pixels). Returns where it begins on the left.
double write_field_bar(const Field& field, double right, double bottom, std::string& out);

}  // namespace krok::draw
