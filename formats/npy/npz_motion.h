#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "scene/frame_source.h"
#include "scene/motion_keys.h"

// Writes a motion as arrays that numpy.load reads: positions, quaternions (x, y, z, w), names,
// parents, end_sites, reference_positions, reference_quaternions, rate, contacts and
// contact_joints. See SPEC.md; npy::read() reads it again.

namespace krok::npy {

// `contacts`: empty for none. Quaternions of a joint stay in one hemisphere from frame to frame.
// The frames are read twice. Codes: zip-damaged, and those of the source.
Result<std::vector<std::byte>> write_motion(const FrameSource& source,
                                            std::span<const Contact> contacts);
// The same, written as it is packed, so that memory does not grow with the number of frames (unless
// the output cannot be rewritten). Errors are those of `file` as well.
Status write_motion(const FrameSource& source, std::span<const Contact> contacts, int jobs,
                    OutputFile& file);

}  // namespace krok::npy
