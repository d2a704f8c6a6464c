#pragma once

#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"

// Writes values over time as CSV.

namespace krok::csv {

// Quantities of items, such as x, y, z of joints, at each frame.
struct SeriesTable {
  double rate = 30;
  int frames = 0;
  std::string item_name;                // header of the items' column: "joint"
  std::vector<std::string> items;       // "LeftFoot"
  std::vector<std::string> quantities;  // at least one: "x", "y", "z"
  // [frames x items x quantities]; NaN where there is no value.
  std::vector<float> values;

  std::size_t columns() const { return items.size() * quantities.size(); }
};

// Both append to `file`; the caller commits. Time is frame / rate in seconds. Numbers have the
// fewest digits that round-trip, missing values are empty fields; names with a comma, a quote or a
// line break are quoted (RFC 4180). Lines end with LF.

// "frame,time,joint,x,y,z" and a row for each frame and item.
Status write_long(const SeriesTable& table, OutputFile& file);

// "frame,time,LeftFoot.x,LeftFoot.y,..." and a row for each frame; of one quantity the names are
// those of the items.
Status write_wide(const SeriesTable& table, OutputFile& file);

}  // namespace krok::csv
