#pragma once

#include <fmt/format.h>

#include <string>

#include "unit/assimp/sample_rig.h"

// The rig as Valve SMD, by the format's description and without any library.

namespace krok::test {

inline std::string smd(const MovingRig& rig, bool mesh, bool motion,
                       const std::string& material = "skin of.bmp") {
  std::string text = "// made for a test\nversion 1\nnodes\n";
  for (std::size_t j = 0; j < rig.names.size(); ++j) {
    text += fmt::format("  {} \"{}\" {}\n", j, rig.names[j], rig.parents[j]);
  }
  text += "end\nskeleton\n";
  const auto write_frame = [&](int time, const std::vector<Pose>& poses) {
    text += fmt::format("time {}\n", time);
    for (std::size_t j = 0; j < poses.size(); ++j) {
      const auto& [t, a] = poses[j];
      text += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", j, t[0], t[1], t[2],
                          a[0], a[1], a[2]);
    }
  };
  if (motion) {
    // Frames at uneven times.
    const int times[] = {0, 1, 4, 6};
    for (std::size_t f = 0; f < rig.frames.size(); ++f) write_frame(times[f], rig.frames[f]);
  } else {
    write_frame(0, rig.rest);
  }
  text += "end\n";
  if (!mesh) return text;
  text += "triangles\n";
  for (const auto& triangle : corner_triangles()) {
    text += material + "\n";
    for (const int corner : triangle) {
      const Vec3 p = corners()[static_cast<std::size_t>(corner)];
      const auto weights = corner_weights()[static_cast<std::size_t>(corner)];
      text += fmt::format("0 {} {} {} 0 0 1 0.25 0.75 {}", p[0], p[1], p[2], weights.size());
      for (const auto& [joint, weight] : weights) text += fmt::format(" {} {}", joint, weight);
      text += "\n";
    }
  }
  return text + "end\n";
}

}  // namespace krok::test
