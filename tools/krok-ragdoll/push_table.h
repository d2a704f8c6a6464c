#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/krok-ragdoll/options.h"

namespace krok::cli::ragdoll {

// A fall of a table: a row.
struct TableFall {
  std::string name;       // unique
  std::string file_name;  // from the name, unique
  ClipTime at;
  PushAt push;
  Location at_place, joint_place, time_place;  // for messages
};

// Reads a CSV table with a header: name, at (seconds), joint, x, y, z (newton seconds), and maybe
// time (seconds); units may be given as in "at [ms]". `path` is for messages. Codes, with line and
// column: those of csv::Table; pushes-column (a column that is not known, missing, twice there or
// has a unit of another kind), pushes-value (an empty cell, a number out of range, or none),
// pushes-name (a name twice there).
Result<std::vector<TableFall>> read_push_table(std::string_view text, const std::string& path);

}  // namespace krok::cli::ragdoll
