#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/json_internal.h"
#include "core/result.h"

// Private to this folder: a GLB from its JSON and its data.

namespace krok::gltf {

// What begins in a buffer begins at a multiple of this.
inline constexpr std::size_t kAlignment = 4;

// Bytes appended to a buffer; where they begin. Its size stays a multiple of kAlignment.
std::size_t append_aligned(std::span<const std::byte> bytes, std::vector<std::byte>& buffer);

// `data` becomes the file's only buffer; none where it is empty. Code gltf-too-large.
Result<std::vector<std::byte>> assemble_glb(nlohmann::ordered_json& json,
                                            std::span<const std::byte> data);

}  // namespace krok::gltf
