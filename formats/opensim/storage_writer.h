#pragma once

#include <string>

#include "core/file.h"
#include "core/result.h"
#include "formats/csv/csv_writer.h"

// Writes OpenSim's storage files, .sto and .mot. Source: OpenSim documentation, "Storage (.sto)
// Files" and "Motion (.mot) Files"; the header is that of version 1, which OpenSim 3 and 4 read.

namespace krok::opensim {

// The table in wide form: a header, then time and a column for each item and quantity, separated by
// tabs; missing values are nan. `degrees` says that angles are in degrees, not radians. Names must
// have no white space; it is written as _. The caller commits.
Status write(const csv::SeriesTable& table, const std::string& name, bool degrees,
             OutputFile& file);

}  // namespace krok::opensim
