#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "capture/capture.h"
#include "core/result.h"
#include "positions/position_skeleton.h"
#include "scene/frame_source.h"
#include "scene/skeleton.h"

// Motions in arrays of numpy, .npy and .npz, by what they hold; SPEC.md lists the names of arrays:
//
// - what krok-export writes: positions, quaternions, names, parents, reference pose;
// - poses of SMPL, SMPL-H and SMPL-X, as AMASS and others have them;
// - rotations with positions, as Kimodo has them;
// - positions alone, of which the rotations are found: positions/from_positions.h.

namespace krok::npy {

struct ReadOptions : CaptureOptions {
  // What the columns of the array are. Empty: by the arrays, or their number.
  std::optional<PositionSkeleton> columns;
  std::string columns_name;  // for messages
  // A skeleton in Krok's frame: for positions the columns, in its order, and the directions of
  // bones; for poses of SMPL the body, by names or in the same order.
  std::optional<Skeleton> skeleton;
  // The content of a model of SMPL (SMPLX_NEUTRAL.npz), of which the joints of a shape are taken.
  std::span<const std::byte> body;
  // The motion of an array of several, from 0; empty: the first, with a warning.
  std::optional<int> motion;
};

struct Capture : krok::Capture {
  std::size_t motions = 1;     // in the file
  bool has_rotations = false;  // false: found from the positions
  // For rotations that were found; metres, as of PoseFromPositions.
  double noise = 0, rms = 0, largest = 0;
};

// strictness repair: values that are not finite are filled from the frames before and after,
// otherwise they are errors. The joints of the clip are in the order of the skeleton, parents
// first.
//
// Codes: those of npy.h, npy-arrays (no arrays of a known kind), npy-shape (not a motion's shape),
// npy-skeleton (joints unknown, or of another number), npy-value (not finite, or over 1e9 m away),
// npy-rotation (a matrix that is no rotation), npy-rate, npy-limit, direction-parallel, those of
// arrange(). Of warnings and notes besides: npy-unit, npy-up, npy-forward, npy-body, npy-motion,
// npy-bones, npy-fit, npy-glitch, npy-ground, npy-noise, npy-repair, npy-root, npy-sides.
Result<Capture> read(std::span<const std::byte> file, const std::string& file_name,
                     const ReadOptions& options = {});

// A capture whose frames are unpacked as they are read: its clip has none. `frames` is valid as
// long as the file's bytes are; it is to be read about in order.
struct OpenedCapture : Capture {
  FrameSource frames;
};

// Opens arrays of an archive as krok-export writes them, to be read in parts: the same frames as of
// read(). They are looked through once, for conventions and contacts. Empty for any other file, for
// arrays of fewer joint transforms, and where a fault is found; if a frame later gives an Error,
// discard the result. read() then reports what is wrong.
std::optional<OpenedCapture> open(std::span<const std::byte> file, const std::string& file_name,
                                  const ReadOptions& options = {}, std::size_t min_transforms = 0);

// Reads a skeleton of columns from JSON: {"schema": "krok.columns/1", "rate": 30, "joints":
// [{"name": "hips", "parent": ""}, ...]}, see SPEC.md. Codes: json-syntax, json-limit,
// columns-structure, columns-value, and those of arrange().
Result<PositionSkeleton> read_columns(std::string_view text);

// Whether the arrays are a model of SMPL: v_template and J_regressor.
bool is_smpl_body(std::span<const std::byte> file);

}  // namespace krok::npy
