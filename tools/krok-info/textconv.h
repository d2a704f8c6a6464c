#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "tools/cli/tool.h"

namespace krok::cli::info {

// A motion as text for `git diff`, at most 2,000 lines: for each stretch of time (a second, or more
// of long motions) and each joint the range of its rotation in its parent (rotation vector,
// degrees) and a checksum of its values to 0.001 degrees, of the root also its place (mm, to
// 0.01 mm). A change of one joint in one frame changes one line; how a file writes its numbers
// changes none. A Git LFS pointer and a file that cannot be read are one line.
//
// Empty for a file that holds no motion.
std::optional<std::string> textconv(const InputFile& file);

}  // namespace krok::cli::info
