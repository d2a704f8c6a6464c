#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "capture/capture.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/io/inputs.h"
#include "scene/frame_source.h"

// Motion captures (BVH; AMC with its ASF; ASF alone; arrays of numpy) with the choices a user may
// make about them. Reads sequentially where the format and the file allow it, so that a long
// capture is never held in memory as a whole; companions are found here. open_motion() reads
// captures through this, with all choices detected.

namespace krok::io {

struct CaptureReading : CaptureOptions {
  RestFrame rest_frame = RestFrame::keep;
  // Path of the ASF of an AMC; empty: found beside it, with a note. For arrays see open_arrays().
  std::string skeleton;
  std::optional<int> motion;  // of an array of several, from 0; empty: the first, with a warning
  // BVH only; other values are refused (code usage) for other formats.
  bvh::Positions positions = bvh::Positions::automatic;
  bvh::Angles angles = bvh::Angles::degrees;
};

// What only some formats know.
struct CaptureDetails {
  std::optional<Choice> positions;
  std::optional<Choice> exporter;
  std::optional<long long> frames_announced;
  std::optional<long long> first_frame_number;
  struct RestFrameFound {
    bool found = false;
    bool left_out = false;
  };
  std::optional<RestFrameFound> rest_frame;
  struct Companion {
    std::string path;
    std::string reason;
  };
  std::optional<Companion> skeleton;  // found beside the motion
  int motions = 1;                    // in the file
};

struct OpenedCapture {
  // Its clip has frames only if the file was read as a whole.
  std::shared_ptr<Capture> capture;
  FrameSource frames;  // keeps `capture` alive; the file must outlive it
  CaptureDetails details;
  bool streamed = false;
};

// Opens a capture and passes it to `use`, which reads the frames. Where a frame proves damaged on
// the way, `use` is called once more, with what can be read of the whole file, and has to discard
// what it did before. With `whole`, frames are never streamed. The errors are those of the reader,
// of `use`, and usage for a choice that the format does not have; a file in no known format of
// captures is refused as the BVH reader refuses it. Reports nothing: the capture's diagnostics are
// complete, and left to the caller, once all frames were read. The note on a companion that was
// found is reported at once.
Status use_capture(const InputFile& file, Inputs& inputs, const CaptureReading& reading, bool whole,
                   const std::function<Status(const OpenedCapture& opened)>& use);

}  // namespace krok::io
