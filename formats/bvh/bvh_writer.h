#pragma once

#include <string>

#include "core/file.h"
#include "core/result.h"
#include "math/euler.h"
#include "scene/clip.h"

namespace krok::bvh {

struct WriteOptions {
  // The order of the rotation channels. The default ZXY is what most programs write for figures
  // with +Y up: its middle angle, where gimbal lock sits, is the bend about the x axis.
  EulerOrder order = {Axis::z, Axis::x, Axis::y};

  // The size of the numbers' unit. BVH does not say it; centimetres are what most readers expect.
  double unit_metres = 0.01;

  // Decimals of angles (degrees), and of lengths in a centimetre; other units get as many more or
  // fewer as keep the same fineness. With 6, positions come back within 1e-6 m and orientations
  // within 1e-6 rad, as far as floats hold them.
  int decimals = 6;

  // Writes the root's reference position as its OFFSET. Without it the root's OFFSET is 0 0 0,
  // which every reader takes alike; with it, readers that add position channels to OFFSETs misplace
  // the figure. Either way the root's channels hold its place.
  bool root_offset = false;

  // Joints other than the root get position channels where their translation in the parent leaves
  // the OFFSET by more than this (metres), or by more than float rounding can explain. The channels
  // replace the OFFSET.
  double translation_tolerance = 1e-6;

  // Spaces in names are written as they are; many readers take only the first word. A character
  // here replaces each ("_").
  std::string space_in_names = " ";
};

// Writes a clip as BVH text in Krok's axes (+Y up, facing +Z): appends to `file`, the caller
// commits.
//
// OFFSETs come from the reference pose, whose orientations BVH cannot hold: they are folded into
// the motion, so that world positions come back and a joint's frame in the file's rest pose is the
// world's. Angles are continuous over frames. Joints stand depth first; those marked as end sites
// become End Sites, which have no name of their own (they read back as <parent>_end) and no motion:
// an end site that moves in its parent is written as a joint. Leaves that are no
// end sites have none written for them. Line ends are LF; a rate is printed as the frame time with
// enough digits to read back as the same rate.
//
// An Error for what check() refuses, before anything is written; code bvh-options for options out
// of range.
Status write(const Clip& clip, const WriteOptions& options, OutputFile& file);

}  // namespace krok::bvh
