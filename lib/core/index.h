#pragma once

#include <cstddef>

namespace krok {

// Converts a non-negative joint, frame or vertex number to a container index.
constexpr std::size_t at(int number) {
  return static_cast<std::size_t>(number);
}

}  // namespace krok
