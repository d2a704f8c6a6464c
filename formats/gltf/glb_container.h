#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/result.h"

// The GLB container. Source: glTF 2.0 Specification, section 4 (GLB).

namespace krok::gltf {

struct Container {
  std::string_view json;
  std::size_t json_offset = 0;     // in the file
  bool binary = false;             // GLB, not .gltf
  std::span<const std::byte> bin;  // the BIN chunk; empty if there is none
};

// The views point into `bytes`. Code: gltf-container.
Result<Container> open_container(std::span<const std::byte> bytes);

}  // namespace krok::gltf
