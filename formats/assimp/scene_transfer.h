#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "nodes/scene.h"

// A nodes::Scene as bytes, to bring it from one process to another of the same program. Not a file
// format: it has no version and may change at any time.

namespace krok::assimp {

std::vector<std::byte> pack(const nodes::Scene& scene);

// Trusts nothing: counts are held against the bytes that are there, and everything that
// nodes/scene.h promises of indices, sizes, times and finite values is checked, so that a scene
// from a process that went astray is an Error (code assimp-result) and not a crash later.
Result<nodes::Scene> unpack(std::span<const std::byte> bytes);

}  // namespace krok::assimp
