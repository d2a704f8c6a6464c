#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "gait/path.h"

// Ways over the ground as CSV, JSON or SVG; see formats/path/SPEC.md.

namespace krok::path_file {

struct ReadOptions {
  double metres_per_unit = 0.01;  // of an SVG; > 0
  std::string id;                 // of the element of an SVG; empty: the first path or polyline
};

// Reads the points of a way: SVG if the text begins with '<', SVG path data if it begins with M or
// m, JSON if it begins with a brace, otherwise CSV. Curves become points at most 2 cm apart. `path`
// is for messages, which have line and column. At most 4,000,000 points. Codes: those of
// csv::Table; json-syntax, json-limit; path-structure, path-value (JSON); path-column, path-value
// (CSV); path-svg (no way in the file, or one that is not understood), path-data (a mistake in path
// data), path-limit.
Result<std::vector<gait::PathPoint>> read(std::string_view text, const std::string& path,
                                          const ReadOptions& options = {});

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::path_file
