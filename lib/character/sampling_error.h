#pragma once

#include <optional>

#include "character/motion.h"

// What a motion loses by being sampled: between its frames glTF's loaders interpolate position and
// rotation of each joint relative to its parent, whatever the keys of the source did there.

namespace krok::character {

struct SamplingError {
  double largest = 0;  // metres: of a joint's position between two frames
  int joint = -1;      // index in the rig
  double time = 0;     // of the result, seconds
  bool jumps = false;  // a key steps, which becomes a ramp of one frame at any rate
  // A multiple of the rate at which it is at most `wanted`; none up to 32 times.
  std::optional<double> rate;
};

// Whether an animation can lose anything: it has keys between frames, splines or steps.
bool is_sampled_exactly(const nodes::Animation& animation, const Sampling& sampling);

// Measured at the quarters between frames. `wanted` in metres.
SamplingError sampling_error(const nodes::Evaluator& evaluator, const Rig& rig,
                             const Conversion& conversion, const nodes::Animation& animation,
                             int index, const Sampling& sampling, double wanted, int jobs);

}  // namespace krok::character
