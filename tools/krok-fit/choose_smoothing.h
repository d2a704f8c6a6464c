#pragma once

#include <optional>
#include <vector>

#include "parametric/leave_one_out.h"
#include "tools/krok-fit/library_input.h"
#include "tools/krok-fit/options.h"

// Whether the weights of a library meet its examples, or average what is chance in them.

namespace krok::fit_tool {

struct SmoothingChoice {
  double smoothing = 0;  // what the weights get
  // How well examples are made by the others where weights meet them, and what smoothing gave; both
  // empty where none was tried.
  std::optional<parametric::LeftOutMeans> exact;
  std::vector<parametric::SmoothingTrial> tried;
};

// As the options say. Left to itself (--smooth auto), smoothing is tried for steps that were found,
// at least kLeastInside of them between the others, where planes alone make examples better than
// weights that meet the others: the steps contradict each other. The best of a series is taken if
// it brings the distance to kGain of what it was. With smoothing the library gets all steps that
// were found.
inline constexpr int kMinInside = 5;
inline constexpr double kGain = 0.8;
bool contradict_each_other(const parametric::LeftOutMeans& exact);
Result<SmoothingChoice> choose_smoothing(LibraryInput& input, const Options& options,
                                         ToolContext& context);

}  // namespace krok::fit_tool
