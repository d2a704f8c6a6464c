#pragma once

#include <fmt/format.h>

#include "core/nearest_name.h"
#include "core/text.h"
#include "formats/weights/weights.h"

// Private to this folder: readers of the two file kinds.

namespace krok::weights {

inline constexpr double kUsualRate = 30;
inline constexpr double kLatest = 1e6;         // seconds
inline constexpr double kLargestWeight = 1e6;  // of either sign

Result<WeightFile> read_table(std::string_view text, const std::string& path,
                              std::span<const std::string> targets);
Result<WeightFile> read_keys(std::string_view text, std::span<const std::string> targets);

// An error for an unknown target, without a location.
inline Error unknown_target(std::string_view name, std::span<const std::string> targets) {
  const std::string nearest = nearest_name(name, targets);
  return Error("weights-target", fmt::format("there is no target '{}'", shown(name)),
               nearest.empty() ? std::string("krok-morph info lists the targets")
                               : fmt::format("did you mean '{}'?", shown(nearest)));
}

}  // namespace krok::weights
