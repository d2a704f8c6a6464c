#pragma once

#include <cstddef>

namespace krok::fit::detail {

// Adds `count` rows of n numbers to another of n, times factors that stand `stride` apart. The best
// for this machine; the same bits on all.
void add_products(const double* factors, std::size_t stride, const double* rows, std::size_t count,
                  std::size_t n, double* to);

}  // namespace krok::fit::detail
