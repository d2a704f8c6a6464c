#pragma once

#include <functional>
#include <span>
#include <string>

#include "blend/blend_clips.h"
#include "core/result.h"
#include "scene/frame_source.h"

// Blends of motions that do not fit in memory.

namespace krok::blend {

struct BlendSource {
  std::string name;  // for messages
  FrameSource frames;
  const MotionKeys* keys = nullptr;  // as in BlendInput; must outlive the result, if set
  WeightCurve weight;
};

struct BlendedFrames {
  FrameSource frames;  // to be read about in order
  // What blend_clips() gives besides, complete once the frames were read; of the clip the skeleton
  // and the rate alone.
  std::function<Blended()> done;
};

// As blend_clips() of the same motions. Each source is read once or twice beforehand, and where it
// is blended as the result is read. Kept are the times and the ground frames of all frames, about
// 100 bytes for each. Errors are those of blend_clips() and of the sources.
Result<BlendedFrames> blend_frames(std::span<const BlendSource> sources, const RoleMap& roles,
                                   const Correspondence& correspondence,
                                   const BlendOptions& options);

}  // namespace krok::blend
