#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Reader for sequences, named parts of one long take (JSON, hand-written); see
// formats/sequences/SPEC.md.

namespace krok::sequences {

struct Sequence {
  std::string name;
  int first = 0, last = 0;  // frames, zero-based, inclusive; first <= last
  double speed = 1;         // > 0; 2 plays it twice as fast
  bool loop = false;        // whether it repeats
};

struct SequenceFile {
  double rate = 0;                  // frame rate of the frame numbers; 0 for that of the motion
  std::vector<Sequence> sequences;  // names unique

  const Sequence* find(std::string_view name) const;
};

// Codes: json-syntax, json-limit, sequences-structure, sequences-value, each with line and column.
Result<SequenceFile> read(std::string_view text);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::sequences
