#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "core/file.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/stretch.h"

// Krok's motion format, .anim; formats/anim/SPEC.md describes the bytes.

namespace krok::anim {

// Reads a clip; it passes check(). Orientations stored as x, y, z are read with w <= 0. Safe for
// untrusted input: memory use is bounded by the file size, twice that with stretches.
//
// `stretches` gets those of the joints, none for rigid ones. Without it a file that has them is an
// Error (code anim-stretch).
//
// Codes: those of formats/container/container.h, anim-shape, those of check(Clip) and
// check(Stretches), with byte offsets.
Result<Clip> read(std::span<const std::byte> file, Stretches* stretches = nullptr);

// A motion whose frames are decoded from the file's bytes on demand.
struct Opened {
  FrameSource frames;  // the bytes must outlive it
  Provenance provenance;
  bool stretched = false;  // joints change scale: only read() has by how much
};

// Opens a file without its frames, so that a long one need not fit in memory twice. Frames are
// checked as they are read. `release` is called with the offset before which bytes are no longer
// needed, for the source's release(). Codes: those of read().
Result<Opened> open(std::span<const std::byte> file,
                    std::function<void(std::size_t offset)> release = {});

struct WriteOptions {
  OrientationEncoding orientation = OrientationEncoding::xyz;
  std::span<const Stretch> stretches{};  // [frames x joints], or none
  int jobs = 1;                          // threads; the output does not depend on it
};

// Writes to `file`, which must be empty; the caller commits. Deterministic; a clip that was read
// from a file gives the bytes of that file. An Error if check() fails (such as for NaN), before
// anything is written.
Status write(const Clip& clip, const WriteOptions& options, OutputFile& file);

// The same for frames generated on demand, block by block, so that memory does not grow with their
// number (unless the output cannot be rewritten, see ContainerWriter). The output is the same as
// for the loaded clip. `provenance` is called after all frames are written. After an Error of the
// source or the output, `file` is incomplete and must not be committed.
Status write(const FrameSource& source, const std::function<Provenance()>& provenance,
             const WriteOptions& options, OutputFile& file);

}  // namespace krok::anim
