#pragma once

#include <cstddef>
#include <span>

#include "core/file.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "scene/model.h"

// Krok's own format for skinned meshes, .model; formats/model/SPEC.md describes its bytes.

namespace krok::model {

// A model for which check() holds. The skeleton's orientations stored as x, y, z come back with
// w <= 0. Trusts nothing in `file`: memory is taken only for what the file has bytes for. Codes:
// those of formats/container/container.h, model-shape, those of check(Model), with byte offsets.
Result<Model> read(std::span<const std::byte> file);

struct WriteOptions {
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// Appends the whole file to `file`, to which nothing was written before; the caller commits. The
// same model gives the same bytes, and a model that was read from a file gives that file's. An
// Error for what check() refuses (NaN, for one), before anything is written.
Status write(const Model& model, const WriteOptions& options, OutputFile& file);

}  // namespace krok::model
