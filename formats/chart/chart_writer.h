#pragma once

#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "draw/plot.h"

// Charts as files. A chart is SVG (draw::to_svg); as PDF or PNG it is what rsvg-convert makes of
// that, which is looked up in PATH when it is needed. PDF keeps lines and text.

namespace krok::chart {

// ".svg", ".pdf", ".png".
std::vector<std::string> endings();

// Writes a chart to an empty file for `path`, by its extension; other extensions are SVG. PNG has
// 192 pixels per inch, on white. Same bytes on every run with the same version of rsvg-convert and
// the same fonts. Codes: chart-program if it is not installed, program-start, program-failed.
Status write(const std::string& path, const std::string& svg, OutputFile& file);

// The points of a chart's named lines as a table: "panel,line,x,y,deviation,x_axis,y_axis". The
// deviation is half of the height of the band around the line, empty without one. Numbers
// round-trip.
std::string csv_of(const draw::Chart& chart);

}  // namespace krok::chart
