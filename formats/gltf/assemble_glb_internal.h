#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/json_internal.h"
#include "core/result.h"

// Private to this folder: builds a GLB from JSON and binary data.

namespace krok::gltf {

// Alignment of buffer views, bytes.
inline constexpr std::size_t kAlignment = 4;

// Appends bytes and returns their offset. Pads the buffer to a multiple of kAlignment.
std::size_t append_aligned(std::span<const std::byte> bytes, std::vector<std::byte>& buffer);

// `data` becomes the file's only buffer with bytes, before `more_buffers`; no buffer if it is
// empty. Code: gltf-too-large.
Result<std::vector<std::byte>> assemble_glb(
    nlohmann::ordered_json& json, std::span<const std::byte> data,
    std::span<const nlohmann::ordered_json> more_buffers = {});

}  // namespace krok::gltf
