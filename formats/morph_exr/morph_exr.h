#pragma once

#include <cstddef>
#include <span>

#include "core/file.h"
#include "core/result.h"
#include "scene/morph_set.h"

// Morph targets in a float texture, an OpenEXR file that a shader can take as it is: the upper half
// holds the positions of all targets, the lower half their normals. formats/morph_exr/SPEC.md tells
// where a vertex stands.
//
// Codes: exr-header (not an OpenEXR file, or one of a kind that is not read), exr-morphs (an
// OpenEXR file without targets, or whose counts do not fit its size), exr-data (the pixels are
// damaged), and those of check(MorphSet).

namespace krok::morph_exr {

// Trusts nothing in `file`: memory is taken only in proportion to its bytes.
Result<MorphSet> read(std::span<const std::byte> file);

// How large the picture of such a file is, in texels; both halves together.
struct ImageSize {
  int width = 0, height = 0;
};
Result<ImageSize> image_size(std::span<const std::byte> file);

// Appends the whole file to `file`, to which nothing was written before; the caller commits. The
// same targets give the same bytes, and targets that were read come back bit for bit. An Error for
// what check() refuses, and for sets without targets or too large for a picture of 16384 by 32768
// texels (code exr-morphs).
Status write(const MorphSet& morphs, OutputFile& file);

}  // namespace krok::morph_exr
