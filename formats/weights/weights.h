#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/morph_set.h"
#include "skin/morph.h"

// Reader for morph target weights over time: a table (CSV) as written by krok-import, or
// hand-written keys (JSON). See formats/weights/SPEC.md.
//
// Codes, with line and column: json-syntax, json-limit, those of csv::Table, weights-structure,
// weights-value, weights-time (times not increasing), weights-target (unknown target; the hint
// names the nearest one).

namespace krok::weights {

struct WeightFile {
  MorphCurves curves;          // for all targets, in their order; 0 for those not in the file
  std::optional<double> rate;  // frames per second, if in the file or the table has even times
};

// `text` is JSON if its first character is a brace, otherwise a table. `path` is for messages. Safe
// for untrusted input.
Result<WeightFile> read(std::string_view text, const std::string& path,
                        std::span<const std::string> targets);

// A warning of the first weight over 10, where 1 is the whole target: of per cent. Code
// morph-weights.
std::optional<Diagnostic> implausible_weight(const MorphCurves& curves);

// The same, sampled at even times from 0 to the last time in the file: at `rate`, or else the rate
// of the file, or else 30 fps. A table with even times from 0 is returned unchanged at its own
// rate. Usable with a motion of any length: weights_at() holds the last weights.
Result<MorphWeights> read_weights(std::string_view text, const std::string& path,
                                  const MorphSet& morphs, std::optional<double> rate = {});
Result<MorphWeights> sampled(const WeightFile& file, const std::string& path,
                             std::optional<double> rate = {});

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::weights
