#pragma once

#include <cstddef>

namespace krok {

// A joint's, frame's or vertex's number (not negative) as an index of a container.
constexpr std::size_t at(int number) {
  return static_cast<std::size_t>(number);
}

}  // namespace krok
