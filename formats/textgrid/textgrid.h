#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Reader for TextGrid files of Praat, and for tables of intervals; see SPEC.md.

namespace krok::textgrid {

struct Interval {
  double start = 0, end = 0;  // seconds, start < end
  std::string label;          // UTF-8; may be empty
  Location where;             // of the label, with the file's name
};

struct Tier {
  std::string name;
  bool points = false;              // of times without duration: each interval has start = end
  std::vector<Interval> intervals;  // by time
};

struct TextGrid {
  double start = 0, end = 0;  // seconds
  std::vector<Tier> tiers;
};

// A TextGrid as text, in the long or the short form, UTF-8 or UTF-16. Safe for untrusted input.
// Codes, with line and column: textgrid-kind (another kind of file), textgrid-structure (not what
// the format has there), textgrid-value (a number that is no time or count), textgrid-time (times
// that go back).
Result<TextGrid> read(std::string_view bytes, const std::string& path);

// Intervals of a tier of a TextGrid, or of a CSV table with the columns start, end (seconds) and
// label. `tier` empty: the one called "phones" or "phonemes" in any case, or else the only interval
// tier. Codes: those of read() and of csv::Table, textgrid-tier (no such tier), csv-column,
// textgrid-time.
Result<std::vector<Interval>> read_intervals(std::string_view bytes, const std::string& path,
                                             const std::string& tier);

}  // namespace krok::textgrid
