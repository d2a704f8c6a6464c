#pragma once

#include <string>

#include "core/result.h"
#include "nodes/scene.h"
#include "tools/cli/tool.h"

// The animations of a scene, by name or number.

namespace krok::cli {

// From the file, as UTF-8, or "animation 3".
std::string animation_name(const nodes::Scene& scene, std::size_t index);

// "0 (walk), 1 (run)", of at most 20, for messages.
std::string animation_list(const nodes::Scene& scene);

// The animation of that name, else of that number. Code clip-name if there is none; `file` is for
// the message.
Result<int> find_animation(const nodes::Scene& scene, const std::string& wanted,
                           const std::string& file);

// The same, where an empty `wanted` is the first, with a warning (code clip-first) if there are
// others; -1 for a scene without any, unless one is wanted.
Result<int> choose_animation(const nodes::Scene& scene, const std::string& wanted,
                             const std::string& file, ToolContext& context);

}  // namespace krok::cli
