#pragma once

#include <string>

#include "core/result.h"
#include "fit/refine.h"
#include "tools/krok-fit/library_input.h"

namespace krok::fit_tool {

// What a library that was fitted before says of its refinement, so that it can go on. `text` is the
// file's report. Code fit-resume where it tells of no refinement, or of other parameters or points.
Result<fit::Refined> read_refinement(const std::string& text, const LibraryInput& input,
                                     const rbf::WeightFunction& function);

}  // namespace krok::fit_tool
