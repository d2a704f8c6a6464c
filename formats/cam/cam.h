#pragma once

#include <cstddef>
#include <span>

#include "core/file.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "scene/camera_track.h"

// Krok's own format for cameras over time, .cam; formats/cam/SPEC.md describes its bytes.

namespace krok::cam {

// A track for which check() holds. Orientations stored as x, y, z come back with w <= 0. Trusts
// nothing in `file`: memory is taken only for what the file has bytes for. Codes: those of
// formats/container/container.h, camera-shape, those of check(CameraTrack), with byte offsets.
Result<CameraTrack> read(std::span<const std::byte> file);

struct WriteOptions {
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// Appends the whole file to `file`, to which nothing was written before; the caller commits. The
// same track gives the same bytes, and a track that was read from a file gives that file's. An
// Error for what check() refuses (NaN, for one), before anything is written.
Status write(const CameraTrack& camera, const WriteOptions& options, OutputFile& file);

}  // namespace krok::cam
