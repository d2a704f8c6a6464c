#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "core/file.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

// Krok's own motion format, .anim; formats/anim/SPEC.md describes its bytes.

namespace krok::anim {

// A clip for which check() holds. Orientations stored as x, y, z come back with w <= 0. Trusts
// nothing in `file`: memory is taken only for what the file has bytes for. Codes: those of
// formats/container/container.h, anim-shape, those of check(Clip), with byte offsets.
Result<Clip> read(std::span<const std::byte> file);

struct WriteOptions {
  OrientationEncoding orientation = OrientationEncoding::xyz;
  int jobs = 1;  // threads; the bytes do not depend on them
};

// Appends the whole file to `file`, to which nothing was written before; the caller commits. The
// same clip gives the same bytes, and a clip that was read from a file gives that file's. An Error
// for what check() refuses (NaN, for one), before anything is written.
Status write(const Clip& clip, const WriteOptions& options, OutputFile& file);

// The same for frames that are made when they are asked for, block by block, so that memory does
// not grow with their number (but where the output cannot be rewritten, see ContainerWriter). The
// bytes are those of the loaded clip. `provenance` is asked for once all frames are written. After
// an Error, of the source or of the output, `file` holds a part and must not be committed.
Status write(const FrameSource& source, const std::function<Provenance()>& provenance,
             const WriteOptions& options, OutputFile& file);

}  // namespace krok::anim
