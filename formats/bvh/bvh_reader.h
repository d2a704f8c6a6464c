#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "capture/capture.h"
#include "capture/rest_frame.h"
#include "core/result.h"
#include "scene/frame_source.h"

// Biovision hierarchy files (BVH) as they are found: M. Meredith and S. Maddock, "Motion capture
// file formats explained", University of Sheffield, 2001, describes the format; what exporters make
// of it differs, and this reader says what it met and what it chose.

namespace krok::bvh {

// What position channels mean. absolute: they replace the joint's OFFSET. additive: they are added
// to it. Files do not say; most are absolute.
enum class Positions { automatic, absolute, additive };

// What rotation channels are in. The format has degrees; a file that looks otherwise gets a
// warning.
enum class Angles { degrees, radians };

struct ReadOptions : CaptureOptions {
  // strictness normal: rows that are not whole are left out and reported, a number that is no
  // number is an error. strict: whatever would be a fault in the data is an error. repair: faulty
  // frames are filled from their neighbours, or left out at the ends; each repair is listed. With
  // metres, up +y and forward +z given, numbers pass through unconverted.
  Positions positions = Positions::automatic;
  Angles angles = Angles::degrees;
  RestFrame rest_frame = RestFrame::keep;
};

// The clip's reference pose has the OFFSETs with zero rotations, and identity orientations: joint
// frames are turned together with the axes, so that each joint's frame in the reference pose is
// Krok's. End Sites are joints named <parent>_end. Joints stand in the file's order.
struct Capture : krok::Capture {
  Choice positions;
  double frame_time = 0;           // seconds, as printed; 0 where there is none
  long long frames_announced = 0;  // what Frames: says
  bool rest_frame_found = false;   // the first frame is a rest pose
  bool rest_frame_dropped = false;
};

// Reads a whole file. `text` need not outlive the call; `file_name` is for messages.
//
// World transforms are computed in doubles along each joint's own channels in their own order, and
// stored as floats. Frames have increasing times without gaps: a row left out in the middle moves
// the later frames to the front, which the warning says.
//
// Codes of errors: bvh-kind (not a BVH file), bvh-syntax, bvh-number, bvh-channels,
// bvh-channel-count, bvh-frame-count, bvh-frame-time, bvh-no-motion, bvh-limit, direction-parallel.
// Of warnings and notes besides these: bvh-name, bvh-name-duplicate, bvh-roots, bvh-offset,
// bvh-text-after, bvh-positions, bvh-rate, bvh-unit, bvh-up, bvh-forward, bvh-rest-frame,
// bvh-reference, bvh-repair, bvh-cut, bvh-zero-bones, bvh-exporter, bvh-angles, bvh-text-before,
// bvh-far-rotation and bvh-far-position (capture/far_values.h: numbers beyond sense; the first of
// each is told, or an error where reading is strict).
Result<Capture> read(std::string_view text, const std::string& file_name,
                     const ReadOptions& options = {});

// A capture whose frames are read when they are asked for; `clip` has its skeleton, rate and
// conversions, but no frames. `frames` views the text and is valid as long as that is.
struct OpenedCapture : Capture {
  FrameSource frames;
};

// The beginning of a file, and a few rows to work out what read() works out, without reading the
// rest: for files of any length. Gives nothing where the file is not a row a line throughout, as
// many as announced, or has any other fault: read() tells it then. The same holds where a frame
// gives an Error: a row there proved not to be whole or to have numbers beyond sense, so that what
// was read of the file is worth nothing.
//
// `release`, which may be empty, is called by the source's release() with the offset of the text
// before which nothing is read any more.
std::optional<OpenedCapture> open(std::string_view text, const std::string& file_name,
                                  const ReadOptions& options,
                                  std::function<void(std::size_t offset)> release = {});

}  // namespace krok::bvh
