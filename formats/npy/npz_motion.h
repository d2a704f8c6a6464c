#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Writes a motion as arrays that numpy.load reads: positions, quaternions (x, y, z, w), names,
// parents, end_sites, reference_positions, reference_quaternions, rate, contacts and
// contact_joints. See SPEC.md; npy::read() reads it again.

namespace krok::npy {

// `contacts`: empty for none. Quaternions of a joint stay in one hemisphere from frame to frame.
// Code: zip-damaged.
Result<std::vector<std::byte>> write_motion(Clip clip, std::span<const Contact> contacts);
// The same, written as it is packed. Errors are those of `file` as well.
Status write_motion(Clip clip, std::span<const Contact> contacts, OutputFile& file);

}  // namespace krok::npy
