#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/morph_set.h"
#include "skin/morph_curves.h"

// How much of each morph target shows over time, as text: a table (CSV) as krok-import writes it,
// or keys that people write (JSON). formats/weights/SPEC.md describes both.
//
// Codes, with line and column: json-syntax, json-limit, those of csv::Table, weights-structure,
// weights-value, weights-time (times that do not rise), weights-target (a target that is not
// there; the message names the nearest one that is).

namespace krok::weights {

struct WeightFile {
  MorphCurves curves;          // for all targets, in their order; 0 for those the file leaves out
  std::optional<double> rate;  // frames a second, where the file tells; of a table with even times
};

// `text` is JSON where its first character is a brace, otherwise a table. `path` is for messages.
// Trusts nothing in `text`.
Result<WeightFile> read(std::string_view text, const std::string& path,
                        std::span<const std::string> targets);

// The same at even times from 0 to the file's last one: at `rate`, or else at the file's own, or
// else at 30 frames a second. The rows of a table with even times from 0 come out as they stand
// where `rate` is its own. For a motion of any length: weights_at() goes on with the last ones.
Result<MorphWeights> read_weights(std::string_view text, const std::string& path,
                                  const MorphSet& morphs, std::optional<double> rate = {});

}  // namespace krok::weights
