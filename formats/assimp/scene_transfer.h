#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "nodes/scene.h"

// Serialises a nodes::Scene, to transfer it between processes of the same program. Not a file
// format: unversioned, and may change at any time.

namespace krok::assimp {

std::vector<std::byte> pack(const nodes::Scene& scene);

// For untrusted input: counts are checked against the available bytes, and indices, sizes, times
// and finite values against the requirements of nodes/scene.h, so that a corrupted process gives an
// Error (code assimp-result) and not a crash later.
Result<nodes::Scene> unpack(std::span<const std::byte> bytes);

}  // namespace krok::assimp
