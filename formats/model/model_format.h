#pragma once

#include <cstddef>
#include <span>

#include "core/file.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "scene/model.h"

// Krok's format for skinned meshes, .model; formats/model/SPEC.md describes the bytes.

namespace krok::model {

// Reads a model; it passes check(). Orientations of the skeleton stored as x, y, z are read with
// w <= 0. Safe for untrusted input: memory use is bounded by the file size. Codes: those of
// formats/container/container.h, model-shape, those of check(Model), with byte offsets.
Result<Model> read(std::span<const std::byte> file);

struct WriteOptions {
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// Writes to `file`, which must be empty; the caller commits. Deterministic; a model that was read
// from a file gives the bytes of that file. An Error if check() fails (such as for NaN), before
// anything is written.
Status write(const Model& model, const WriteOptions& options, OutputFile& file);

}  // namespace krok::model
