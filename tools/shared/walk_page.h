#pragma once

#include <span>
#include <string>

#include "core/result.h"
#include "gait/print.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "terrain/terrain.h"
#include "tools/cli/tool.h"

// The web page of a walk, as krok-view makes it.

namespace krok::cli {

// "29 joints, 240 frames, 60 fps, 3.98 s".
std::string facts_of(const Clip& clip);

// A page of one motion with a generated body, on a ground, with footprints. `name` is its title.
// Codes: those of make_body(), add_ground() and draw::write_viewer_page().
Result<std::string> walk_page(const std::string& name, const Clip& clip, const MotionKeys& keys,
                              const Terrain& ground, std::span<const gait::Print> prints,
                              ToolContext& context);

}  // namespace krok::cli
