#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "tools/common/tool.h"

namespace krok {

// A motion from a file that a tool takes in place of a .anim file: a .anim file itself, or a
// capture (BVH; AMC with the ASF beside it), read as krok-import reads it when it is given no
// options. What the reader chose and found odd is told; the clip's provenance tells its
// conversions. That its first frame is a rest pose may be no more than a note to a user who takes
// parts of the motion in which it is not.
enum class RestFrameTold : unsigned char { warning, note };
Result<Clip> read_motion(const std::string& path, ToolContext& context,
                         RestFrameTold rest_frame = RestFrameTold::warning);

// The same of a file that is open already.
Result<Clip> read_motion(const InputFile& input, ToolContext& context,
                         RestFrameTold rest_frame = RestFrameTold::warning);

// Notes the checksum of a long input (ToolContext::open_long_input) when its use ends, whichever
// way that is. Both arguments must outlive it.
class ChecksumNoted {
 public:
  ChecksumNoted(const InputFile& input, ToolContext& context) : input_(input), context_(context) {}
  ~ChecksumNoted();
  ChecksumNoted(const ChecksumNoted&) = delete;

 private:
  const InputFile& input_;
  ToolContext& context_;
};

// The same frames, that note in `faulty` when one cannot be read, whatever their user makes of
// that. Both arguments must outlive what is returned.
FrameSource watched(const FrameSource& frames, std::atomic<bool>& faulty);

// What is known of a motion once its frames were used.
struct MotionFacts {
  Skeleton skeleton;
  double rate = 30.0;
  int frame_count = 0;
  double duration = 0;
  std::vector<std::string> conversions;  // those of reading a capture
};

// The same for what needs no more than a look at each frame, so that a long capture is never in
// memory as a whole: `use` gets the frames, and what it gives back is passed on. It is called a
// second time where a BVH file proved faulty on the way, then with what can be read of the file;
// what it did before is worth nothing. What the reader has to say is told afterwards.
Result<MotionFacts> use_motion(const std::string& path, ToolContext& context,
                               const std::function<Status(const FrameSource& frames)>& use);

}  // namespace krok
