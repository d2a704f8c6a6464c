#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

// Heights on a grid. Seen from above with +X to the right, row 0 is at the top: columns go along
// +X, rows along +Z. The outermost samples lie on the border.
struct HeightField {
  int columns = 0, rows = 0;          // at least 2 each
  std::vector<float> heights;         // columns * rows, row by row, metres; NaN: a hole
  double width = 0, depth = 0;        // metres along X and Z, from first sample to last, above 0
  double centre_x = 0, centre_z = 0;  // metres
};

// The most samples that a height field may have: 256 MiB of them.
inline constexpr std::int64_t kMaxHeights = std::int64_t{1} << 26;

// Ground that is bilinear between the samples, so it is never above or below those around. There is
// none outside the field, nor in a square of four samples of which one is a hole.
// Codes: ground-size for a field without area, too few or too many samples or heights of another
// count; ground-value for infinite heights; ground-empty if all of it is holes.
Result<std::unique_ptr<Terrain>> height_field(HeightField field);

}  // namespace krok::terrain
