#pragma once

#include <cstddef>
#include <span>
#include <string_view>
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

// The GLB container. Source: glTF 2.0 Specification, section 4 (GLB).

struct Container {
  std::string_view json;
  std::size_t json_offset = 0;     // in the file
  bool binary = false;             // GLB, not .gltf
  std::span<const std::byte> bin;  // the BIN chunk; empty if there is none
};

// The views point into `bytes`. Code: gltf-container.
Result<Container> open_container(std::span<const std::byte> bytes);

}  // namespace krok::gltf
