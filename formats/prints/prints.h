#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "gait/print.h"

// Footprints as CSV or JSON; see formats/prints/SPEC.md.

namespace krok::prints {

// Reads footprints: JSON if the text begins with a brace, otherwise CSV. Sides must alternate and
// times rise. `path` is for messages, which have line and column. CSV has no limit on its size,
// JSON is limited to 16 MiB. Codes: those of csv::Table; json-syntax, json-limit; prints-structure
// (JSON), prints-column (a column that is not known, twice there or missing, or has a unit of
// another kind), prints-value (a missing or impossible value), prints-order (two of a side in a
// row, times that do not rise).
Result<std::vector<gait::Print>> read(std::string_view text, const std::string& path);

// Appends them to `file`; the caller commits. Metres, degrees and seconds with up to six decimals,
// columns of heights and times only if a print has one.
Status write_csv(std::span<const gait::Print> prints, OutputFile& file);
Status write_json(std::span<const gait::Print> prints, OutputFile& file);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::prints
