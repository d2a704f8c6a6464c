#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// A manifest lists the files of a batch: one file per line, with tab-separated fields input, output
// and options. Output and options are optional. Empty lines and lines that begin with # are
// ignored, as is a header line of the three field names. Options are separated by spaces; single or
// double quotes enclose an option with spaces.

namespace krok::cli::batch {

struct ManifestWord {
  std::string text;
  Location where;
};

struct ManifestLine {
  ManifestWord input;
  ManifestWord output;  // empty text if missing
  std::vector<ManifestWord> options;
};

struct Manifest {
  std::vector<ManifestLine> lines;
  Diagnostics errors;  // each with its location; code manifest-line
};

Manifest parse_manifest(std::string_view text, const std::string& file_name);

}  // namespace krok::cli::batch
