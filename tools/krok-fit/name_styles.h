#pragma once

#include "core/result.h"
#include "tools/krok-fit/library_input.h"

// Finds out whether examples are of several people or moods.

namespace krok::cli::fit {

// Gives examples without a style that of their group of captures, if the spread of their steps is
// that of several people or moods; a warning names the groups. A group is named after a word that
// its captures' names have and others lack, if there is one. Sets `input.styles`, for the report.
// Codes: those of parametric::group_styles().
Status name_styles(LibraryInput& input, ToolContext& context);

}  // namespace krok::cli::fit
