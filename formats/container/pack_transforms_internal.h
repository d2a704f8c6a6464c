#pragma once

#include <cstddef>

namespace krok::pack_transforms_detail {

// Scalar reference for the SIMD version of write_transforms with encoding xyz: write_transform for
// each of `count` positions (3 floats each) and orientations (x, y, z, w).
void pack_scalar(const float* positions, const float* orientations, std::size_t count,
                 std::byte* out);

}  // namespace krok::pack_transforms_detail
