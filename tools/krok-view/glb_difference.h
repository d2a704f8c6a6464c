#pragma once

#include <optional>

#include "draw/viewer_page.h"
#include "tools/cli/tool.h"
#include "tools/krok-view/files.h"

namespace krok::cli::view {

// How far the vertices of `file` are from those of `other`, in the animations that both play first,
// as krok-diff compares them. None if they have no vertices to compare, or
// too many times.
Result<std::optional<draw::ViewedDifference>> difference_of(const Files::Glb& other,
                                                            const Files::Glb& file,
                                                            ToolContext& context);

}  // namespace krok::cli::view
