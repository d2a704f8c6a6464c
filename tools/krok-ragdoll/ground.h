#pragma once

#include <string>

#include "ragdoll/world.h"
#include "tools/cli/tool.h"

namespace krok::cli::ragdoll {

// The ground that --ground names, as io::open_terrain() opens it. What is not level becomes
// triangles over a lattice of 2 cm within 4 m of `centre`, those of the highest surface; so a
// step's edge is 2 cm wide. Codes: those of open_terrain(); ragdoll-ground if there is none within
// that.
Result<krok::ragdoll::Surroundings> open_surroundings(const std::string& ground, const Vec3& centre,
                                                      ToolContext& context);

}  // namespace krok::cli::ragdoll
