#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "terrain/shapes.h"

// Height fields from images: OpenEXR and grey PNG. Where they lie is not in the image, but in a
// sidecar or given by the user; see formats/height_field/SPEC.md.

namespace krok::height_field {

struct HeightImage {
  int columns = 0, rows = 0;
  std::vector<float> values;  // row by row from the upper left; NaN: a hole
  // Whether the values are shares of a range, 0 to 1 (PNG), or metres unless a range is given
  // (EXR).
  bool shares = false;
  int levels = 0;  // of grey, of a PNG; 0: any value
};

// Reads an image by its content. EXR: the channel "height", Y, Z or R, the first of these that
// there is, otherwise the first of all; half, float or 32-bit integer, not tiled, lossless. NaN is
// a hole. PNG: grey of any depth; holes where an alpha channel is below a half. For untrusted
// input: memory is proportional to the file's size and to terrain::kMaxHeights. Codes: height-kind
// for other files; height-size for more samples than kMaxHeights; exr-header, exr-data; those of
// image::decode_grey().
Result<HeightImage> read(std::span<const std::byte> file);

// Where a height field lies. What is not given: `centre` is the origin; `range` is that of metres.
struct Placement {
  std::optional<std::array<double, 2>> size;    // metres along X (width) and Z (depth)
  std::optional<std::array<double, 2>> range;   // metres of the values 0 and 1
  std::optional<std::array<double, 2>> centre;  // x, z, metres
};

// Reads the sidecar NAME.ground.json. Codes: json-syntax, json-limit, ground-structure,
// ground-value, each with line and column.
Result<Placement> read_sidecar(std::string_view text);

// Codes: height-placement for an image without a size, or a PNG without a range; those of
// terrain::height_field().
Result<terrain::HeightField> placed(HeightImage image, const Placement& placement);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::height_field
