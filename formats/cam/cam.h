#pragma once

#include <cstddef>
#include <span>

#include "core/file.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "scene/camera_track.h"

// Krok's format for animated cameras, .cam; formats/cam/SPEC.md describes the bytes.

namespace krok::cam {

// Reads a track; it passes check(). Orientations stored as x, y, z are read with w <= 0. Safe for
// untrusted input: memory use is bounded by the file size. Codes: those of
// formats/container/container.h, camera-shape, camera-cut, those of check(CameraTrack), with byte
// offsets.
Result<CameraTrack> read(std::span<const std::byte> file);

struct WriteOptions {
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// Writes to `file`, which must be empty; the caller commits. Deterministic; a track that was read
// from a file gives the bytes of that file. An Error if check() fails (such as for NaN), before
// anything is written.
Status write(const CameraTrack& camera, const WriteOptions& options, OutputFile& file);

}  // namespace krok::cam
