#pragma once

#include <cstddef>

namespace krok::fit::detail {

// Adds `count` rows of n numbers, each times a factor, to `to`; `stride`: distance between factors.
// SIMD, bit-identical on all instruction sets.
void add_products(const double* factors, std::size_t stride, const double* rows, std::size_t count,
                  std::size_t n, double* to);

}  // namespace krok::fit::detail
