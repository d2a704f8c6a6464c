#pragma once

#include <cstddef>
#include <span>

namespace krok {

// Converts a non-negative joint, frame or vertex number to a container index.
constexpr std::size_t at(int number) {
  return static_cast<std::size_t>(number);
}

// Row `index` of a row-major array with rows of `width` values.
template <class Values>
auto row_of(Values& values, int width, int index) {
  const auto count = static_cast<std::size_t>(width);
  return std::span(values).subspan(static_cast<std::size_t>(index) * count, count);
}

}  // namespace krok
