#pragma once

#include <cstddef>
#include <string>

#include "core/result.h"

// Private to this folder: shared wording of the readers' messages.

namespace krok::gltf {

inline constexpr const char* kDamagedHint = "the file is damaged, or its exporter has a bug";

// "node 3 (LeftHand)", or "node 3" if there is no name.
std::string label(const char* kind, std::size_t index, const std::string& name);

// Whether an index is valid for `count` elements.
inline bool exists(int index, std::size_t count) {
  return index >= 0 && static_cast<std::size_t>(index) < count;
}

void warn(Diagnostics& diagnostics, std::string code, std::string message, std::string hint = {});

}  // namespace krok::gltf
