#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// A list of files for a batch, as text: a file a line, with input, output and options between tabs.
// Output and options may be left out. Empty lines and lines that begin with # say nothing, and a
// first line of these three words is a heading. In the options, words stand apart by spaces;
// quotes, single or double, hold a word together.

namespace krok {

struct ManifestWord {
  std::string text;
  Location where;
};

struct ManifestLine {
  ManifestWord input;
  ManifestWord output;  // empty text where there is none
  std::vector<ManifestWord> options;
};

struct Manifest {
  std::vector<ManifestLine> lines;
  Diagnostics errors;  // each with its place; code manifest-line
};

Manifest parse_manifest(std::string_view text, const std::string& file_name);

}  // namespace krok
