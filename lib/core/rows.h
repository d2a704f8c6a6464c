#pragma once

#include <cstddef>
#include <span>

namespace krok {

// Row `index` of values that stand row by row, each of `width`.
template <class Values>
auto row_of(Values& values, int width, int index) {
  const auto count = static_cast<std::size_t>(width);
  return std::span(values).subspan(static_cast<std::size_t>(index) * count, count);
}

}  // namespace krok
