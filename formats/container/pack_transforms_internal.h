#pragma once

#include <cstddef>

namespace krok::pack_transforms_detail {

// The scalar reference of the vectorised write_transforms for encoding xyz: write_transform one by
// one, over `count` positions (3 floats each) and orientations (x, y, z, w).
void pack_scalar(const float* positions, const float* orientations, std::size_t count,
                 std::byte* out);

}  // namespace krok::pack_transforms_detail
