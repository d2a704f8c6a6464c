#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "capture/capture.h"
#include "capture/rest_frame.h"
#include "core/result.h"
#include "scene/frame_source.h"

// Reader for Biovision hierarchy files (BVH). The format is described in M. Meredith and S.
// Maddock, "Motion capture file formats explained", University of Sheffield, 2001. Exporters
// deviate from it; this reader reports deviations and the interpretation it chose.

namespace krok::bvh {

// How position channels are applied. absolute: they replace the joint's OFFSET. additive: they are
// added to it. Files do not state it; most are absolute.
enum class Positions { automatic, absolute, additive };

// Unit of rotation channels. The format uses degrees; a file that looks different gets a warning.
enum class Angles { degrees, radians };

struct ReadOptions : CaptureOptions {
  // strictness normal: incomplete rows are skipped and reported, an invalid number is an error.
  // strict: every fault in the data is an error. repair: invalid frames are interpolated from their
  // neighbours, or dropped at the ends; each repair is listed. With metres, up +y and forward +z,
  // numbers are not converted.
  Positions positions = Positions::automatic;
  Angles angles = Angles::degrees;
  RestFrame rest_frame = RestFrame::keep;
};

// The clip's reference pose is the OFFSETs with zero rotations, and has identity orientations:
// joint frames are rotated with the axes, so that in the reference pose each is aligned with
// Krok's axes. End Sites become joints named <parent>_end. Joints are in file order.
struct Capture : krok::Capture {
  Choice positions;
  double frame_time = 0;           // seconds, as printed; 0 if there is none
  long long frames_announced = 0;  // the value of Frames:
  bool rest_frame_found = false;   // the first frame is a rest pose
  bool rest_frame_dropped = false;
};

// Reads a whole file. `text` need not outlive the call; `file_name` is for messages.
//
// World transforms are computed in doubles, applying each joint's channels in their order in the
// file, and stored as floats. Frames are contiguous: if a row in the middle is skipped, later
// frames move up, and the warning says so.
//
// Codes of errors: bvh-kind (not a BVH file), bvh-syntax, bvh-number, bvh-channels,
// bvh-channel-count, bvh-frame-count, bvh-frame-time, bvh-no-motion (no MOTION section: if strict,
// otherwise a warning, and a skeleton without frames), bvh-limit, direction-parallel.
// Of warnings and notes besides these: bvh-name, bvh-name-duplicate, bvh-roots, bvh-offset,
// bvh-text-after, bvh-positions, bvh-rate, bvh-unit, bvh-up, bvh-forward, bvh-rest-frame,
// bvh-reference, bvh-repair, bvh-cut, bvh-zero-bones, bvh-end-site, bvh-exporter, bvh-angles,
// bvh-text-before, bvh-far-rotation and bvh-far-position (capture/far_values.h: implausibly large
// values; the first of each is reported, as an error if strict).
Result<Capture> read(std::string_view text, const std::string& file_name,
                     const ReadOptions& options = {});

// A capture whose frames are read on demand; `clip` has the skeleton, rate and conversions, but no
// frames. `frames` refers to the text and is valid as long as the text is.
struct OpenedCapture : Capture {
  FrameSource frames;
};

// Opens a file of any length for streaming: reads the header and a few rows, enough to make the
// same choices as read(). Returns nullopt unless each line is one row, as many as announced, and
// there is no other fault; read() then reports what is wrong. If a frame later gives an Error, a
// row was incomplete or had implausibly large values: discard the result and call read().
//
// `release` may be empty. The source's release() calls it with a text offset; bytes before the
// offset are not read again.
std::optional<OpenedCapture> open(std::string_view text, const std::string& file_name,
                                  const ReadOptions& options,
                                  std::function<void(std::size_t offset)> release = {});

}  // namespace krok::bvh
