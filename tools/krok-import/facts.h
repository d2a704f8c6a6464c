#pragma once

#include <string>

#include "formats/io/open_capture.h"
#include "roles/stature.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "tools/cli/tool.h"

// Report contents common to all imported formats.

namespace krok::cli::import {

// Median height from lowest to highest joint, sampled at about a hundred frames; that of the
// reference pose without frames.
double height_of(const Clip& clip);

// Computes the height while other code reads all frames of a source, so that they are read only
// once.
class HeightWatch {
 public:
  explicit HeightWatch(const FrameSource& motion);

  // Wraps the source; this must outlive it.
  FrameSource watched(const FrameSource& motion);

  // Adds frames from `first` on; shape [frames x joints]. Thread-safe for disjoint frames.
  void see(std::size_t first, std::span<const Vec3f> positions);

  // Call after all frames were read.
  double height() const;

 private:
  std::size_t joints_, step_;
  double at_rest_;
  std::vector<double> heights_;  // of every step_th frame
};

Json to_json(const Choice& choice);

// Joints, frames, rate, duration and height of a motion.
Json facts_of(const FrameSource& motion, double height);

// Unit, up and forward, and the axes of the reference pose.
Json facts_of(const Conventions& conventions);

// The full report of a capture with frames `motion`.
Json result_of(const io::OpenedCapture& opened, const FrameSource& motion, double height);

// With -v: prints joint roles, one line per body part.
void log_roles(const Skeleton& skeleton, const RoleMap& roles, ToolContext& context);

// "walk.bvh: 52 joints, 90 frames at 30 fps (2.97 s), height 1.71 m".
std::string line_about(const std::string& input, const FrameSource& motion, double height);

}  // namespace krok::cli::import
