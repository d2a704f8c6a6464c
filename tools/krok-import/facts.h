#pragma once

#include <span>
#include <vector>

#include "capture/capture.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "tools/common/tool.h"

// What the report says of an import, whatever the format.

namespace krok::import {

// The median of how high the figure reaches from its lowest joint, over a hundred frames or so; the
// reference pose where there are none.
double height_of(const Clip& clip);

// The same, taken while something else reads all frames of a source, so that they are made only
// once.
class HeightWatch {
 public:
  explicit HeightWatch(const FrameSource& motion);

  // The source with the watch on it; the watch must outlive it.
  FrameSource watched(const FrameSource& motion);

  // Looks at frames from `first` on, shape [frames x joints]. On any thread, others meanwhile at
  // other frames.
  void see(std::size_t first, std::span<const Vec3f> positions);

  // Once all frames were seen.
  double height() const;

 private:
  std::size_t joints_, step_;
  double at_rest_;
  std::vector<double> heights_;  // of every step_th frame
};

Json to_json(const Choice& choice);

// Joints, frames, rate, duration and height of a motion.
Json facts_of(const FrameSource& motion, double height);

// Unit, up, forward and the reference pose's axes.
Json facts_of(const Conventions& conventions);

// All that is reported of a capture whose frames are `motion`; `details` are those of its format.
Json result_of(const Capture& capture, const FrameSource& motion, double height, Json details);

// With -v: what the joints are, a line for each part of the body.
void say_roles(const Skeleton& skeleton, const RoleMap& roles, ToolContext& context);

// "walk.bvh: 52 joints, 90 frames at 30 /s (2.97 s), height 1.71 m".
std::string line_about(const std::string& input, const FrameSource& motion, double height);

}  // namespace krok::import
