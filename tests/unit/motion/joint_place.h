#pragma once

#include "scene/clip.h"

namespace krok::test {

inline Vec3 joint_place(const Clip& clip, int frame, int joint) {
  return clip.frame_positions(frame)[static_cast<std::size_t>(joint)].cast<double>();
}

}  // namespace krok::test
