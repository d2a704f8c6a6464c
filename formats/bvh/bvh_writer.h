#pragma once

#include <string>

#include "core/file.h"
#include "core/result.h"
#include "math/quaternion.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok::bvh {

struct WriteOptions {
  // Order of the rotation channels. The default ZXY is what most programs write for +Y up
  // characters; gimbal lock occurs at +-90 degrees of the middle angle, the rotation about x.
  EulerOrder order = {Axis::z, Axis::x, Axis::y};

  // Length unit of the file; most readers expect centimetres. BVH does not store it, see
  // unit_mark.h for how this project finds it again.
  double unit_metres = 0.01;

  // Decimals of angles (degrees) and of lengths in centimetres; other units get more or fewer for
  // the same resolution. With 6, a round trip of a capture is within 5e-6 m (positions are floats,
  // and angles add up along the limbs).
  int decimals = 6;

  // Writes the root's reference position as its OFFSET. Without it the root's OFFSET is 0 0 0,
  // which is unambiguous; with it, readers that add position channels to OFFSETs misplace the
  // character. Either way the root's channels store its position, as this project's reader knows.
  bool root_offset = false;

  // Joints other than the root get position channels if their local translation differs from the
  // OFFSET by more than this (metres) and by more than float rounding. The channels replace the
  // OFFSET.
  double translation_tolerance = 1e-6;

  // Replaces each space in names. By default spaces are kept; many readers take only the first
  // word of a name, so "_" is safer for them.
  std::string space_in_names = " ";

  int jobs = 1;  // threads that read a FrameSource; the output does not depend on it
};

// Writes a clip as BVH text in Krok's axes (+Y up, facing +Z): appends to `file`, the caller
// commits.
//
// OFFSETs come from the reference pose. BVH cannot store reference orientations: they are folded
// into the motion, so that world positions are preserved and joint frames in the file's rest pose
// are world-aligned. Euler angles are continuous over frames. Joints are written depth first.
// Joints marked as end sites become End Sites, which have no name (they read back as <parent>_end)
// and no motion: an end site that moves relative to its parent is written as a joint. Other leaves
// do not get an End Site. Line ends are LF; the frame time has enough digits to read back as the
// same rate.
//
// Returns an Error if check() fails, before anything is written; code bvh-options for options out
// of range, bvh-far for positions that no float holds in the unit.
Status write(const Clip& clip, const WriteOptions& options, OutputFile& file);

// The same for frames generated on demand, so that memory does not grow with their number. They are
// read twice: which joints move in their parents is known before the first frame is written. After
// an Error of the source, `file` is incomplete and must not be committed.
Status write(const FrameSource& source, const WriteOptions& options, OutputFile& file);

}  // namespace krok::bvh
