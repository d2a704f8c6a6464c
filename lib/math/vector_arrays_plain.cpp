#include <algorithm>
#include <cmath>
#include <limits>

#include "math/vector_arrays_internal.h"

namespace krok::vector_arrays_detail {

bool all_finite(std::span<const float> numbers) {
  return std::ranges::all_of(numbers, [](float number) { return std::isfinite(number); });
}

void subtract(std::span<const Vec3f> base, std::span<Vec3f> vectors, VectorBounds& bounds) {
  for (std::size_t v = 0; v < vectors.size(); ++v) {
    vectors[v] -= base[v];
    bounds.least = bounds.least.cwiseMin(vectors[v]);
    bounds.most = bounds.most.cwiseMax(vectors[v]);
    bounds.finite = bounds.finite && vectors[v].allFinite();
  }
}

VectorBounds no_bounds() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return {Vec3f::Constant(kInfinity), Vec3f::Constant(-kInfinity), true};
}

}  // namespace krok::vector_arrays_detail
