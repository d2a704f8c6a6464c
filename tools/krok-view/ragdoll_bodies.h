#pragma once

#include <string>

#include "core/result.h"
#include "tools/krok-view/files.h"

namespace krok::cli::view {

// Shows the rigid bodies of a file (formats/ragdoll) on all motions, translucent, in place of other
// bodies. Codes: those of ragdoll_file::read(); usage without a motion.
Status show_ragdoll_bodies(const std::string& path, ToolContext& context, Files& files);

}  // namespace krok::cli::view
