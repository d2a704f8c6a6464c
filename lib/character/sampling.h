#pragma once

#include <optional>
#include <vector>

#include "capture/convention_choice.h"
#include "core/result.h"
#include "nodes/scene.h"

// From keys at times of their own to frames at even times.

namespace krok::character {

// Frame i is the scene at start + i * step seconds, and lies at i / rate in the result.
struct Sampling {
  double start = 0;
  double step = 1.0 / 30.0;
  int frames = 1;
  double rate = 30.0;

  double time(int frame) const { return start + frame * step; }
};

struct SamplingOptions {
  std::optional<double> source_rate;  // frames come so often, whatever the key times say
  std::optional<double> rate;         // of the result
};

struct ChosenSampling {
  Sampling sampling;
  Choice rate;           // where the rate comes from
  double keys_from = 0;  // seconds of the scene's time
  double keys_to = 0;
};

// Frames from the first key of the animation to the last, all its channels taken together, so that
// a motion, a camera and weights of one animation stay in step. If the last key falls between two
// frames one more frame holds it.
//
// The rate: as asked for; or that at which the keys come, if they are even, at least 20 a second,
// snapped to a common rate; or a common rate on whose frames all keys fall; or 60. With
// `source_rate` the keys must come evenly or fall on the frames of one rate, and those are taken
// for frames that come so often.
//
// Notes: scene-rate, scene-start (the first key is not at time 0), scene-end (the last frame is
// later than the last key). Errors: scene-rate (source_rate with uneven keys), scene-too-long (more
// than 10 million frames).
Result<ChosenSampling> choose_sampling(const nodes::Animation& animation,
                                       const SamplingOptions& options, Diagnostics& diagnostics);

// All key times of an animation, rising; those within a microsecond of each other count once.
std::vector<double> distinct_key_times(const nodes::Animation& animation);

// The rate at which `times` (rising) come, if they are even, snapped to a common rate where one
// fits them within what 32-bit floats and three printed decimals leave; nothing otherwise or for
// fewer than two.
std::optional<double> even_rate(const std::vector<double>& times);

// The first common rate, from those most used, on whose frames, counted from the first time, all
// `times` fall.
std::optional<double> common_grid(const std::vector<double>& times);

}  // namespace krok::character
