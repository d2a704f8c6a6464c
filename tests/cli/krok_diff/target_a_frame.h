#pragma once

#include <vector>

#include "support/glb_builder.h"

namespace krok::test {

// As baked clips are: at 60 frames a second, node 0 shows its mesh in the first frame and one of
// its `frames` - 1 morph targets in each further one.
inline void show_a_target_a_frame(int frames, GlbBuilder& builder) {
  std::vector<float> times, weights;
  for (int f = 0; f < frames; ++f) {
    times.push_back(static_cast<float>(f) / 60);
    for (int t = 1; t < frames; ++t) weights.push_back(t == f ? 1.0F : 0.0F);
  }
  builder.json["animations"] = {
      {{"name", "Lean"},
       {"samplers",
        {{{"input", builder.add(times, "SCALAR")}, {"output", builder.add(weights, "SCALAR")}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
}

}  // namespace krok::test
