#pragma once

#include <string>

#include "ragdoll/world.h"
#include "tools/cli/tool.h"

namespace krok::cli::ragdoll {

// The ground that --ground names, as io::open_terrain() opens it. What is not level becomes
// triangles within 10 m of `centre`, to 1 mm (terrain::surface_of()). Codes: those of
// open_terrain(); ragdoll-ground if there is none within that.
Result<krok::ragdoll::Surroundings> open_surroundings(const std::string& ground, const Vec3& centre,
                                                      ToolContext& context);

}  // namespace krok::cli::ragdoll
