#pragma once

#include <cstddef>
#include <span>

#include "core/file.h"
#include "core/result.h"
#include "scene/morph_set.h"

// Morph targets as a float texture: an OpenEXR file that shaders can use directly. The upper half
// has the positions of all targets, the lower half their normals. See formats/morph_exr/SPEC.md for
// the layout.
//
// Codes: exr-header (not an OpenEXR file, or an unsupported kind), exr-morphs (no targets, or
// counts that do not match the image size), exr-data (damaged pixels), and those of
// check(MorphSet).

namespace krok::morph_exr {

// For untrusted input: memory is proportional to the file size.
Result<MorphSet> read(std::span<const std::byte> file);

// Size of the image in texels, both halves together.
struct ImageSize {
  int width = 0, height = 0;
};
Result<ImageSize> image_size(std::span<const std::byte> file);

// Writes the whole file to `file`, which must be empty; the caller commits. Output is deterministic
// and round trips are bit-exact. Codes: those of check(MorphSet); exr-morphs for no targets, or for
// more than an image of 16384 by 32768 texels can hold.
Status write(const MorphSet& morphs, OutputFile& file);

}  // namespace krok::morph_exr
