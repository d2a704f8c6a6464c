#pragma once

#include <string>

#include "core/result.h"
#include "fit/refine.h"
#include "tools/krok-fit/library_input.h"

namespace krok::cli::fit {

// Reads the refinement state from a fitted library's report `text`, to resume it. Code fit-resume
// if there is none, or it does not match the parameters or points.
Result<krok::fit::Refined> read_refinement(const std::string& text, const LibraryInput& input,
                                           const rbf::WeightFunction& function);

}  // namespace krok::cli::fit
