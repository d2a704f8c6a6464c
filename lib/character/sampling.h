#pragma once

#include <optional>
#include <vector>

#include "capture/convention_choice.h"
#include "core/result.h"
#include "nodes/scene.h"

// Samples keyframes at a fixed rate.

namespace krok::character {

// Frame i samples the scene at start + i * step seconds and is at i / rate in the result.
struct Sampling {
  double start = 0;
  double step = 1.0 / 30.0;
  int frames = 1;
  double rate = 30.0;

  double time(int frame) const { return start + frame * step; }
};

struct SamplingOptions {
  std::optional<double> source_rate;  // of the source frames, overriding the key times
  std::optional<double> rate;         // of the result
};

struct ChosenSampling {
  Sampling sampling;
  Choice rate;           // with the reason for it
  double keys_from = 0;  // seconds, scene time
  double keys_to = 0;
};

// Frames from the first key of the animation to the last, over all its channels, so that motion,
// camera and weights of one animation stay in sync. If the last key is between two frames, one more
// frame holds it. With Animation::from_zero they begin at time 0, unless the keys are on frames of
// no rate counted from there (and none is requested), or the first key is later than 60 s.
//
// The rate: as requested; or that of the file, if all keys are on its frames, or if they are over
// 250 a second and a multiple of it, as of curves that were resampled; or that of the keys,
// if they are evenly spaced at 20 fps or more, snapped to a common rate; or a common rate whose
// frames include all keys; or 60. With `source_rate` the keys must be evenly spaced or on the
// frames of one rate, and those are taken as frames at `source_rate`.
//
// Notes: scene-rate, scene-start (the first key is not at time 0; a
// warning if times shift against what viewers play), scene-end (the last frame is
// later than the last key). Errors: scene-rate (source_rate with uneven keys), scene-too-long (more
// than 10 million frames).
Result<ChosenSampling> choose_sampling(const nodes::Animation& animation,
                                       const SamplingOptions& options, Diagnostics& diagnostics);

// All key times of an animation, increasing; those within a microsecond of each other count once.
std::vector<double> distinct_key_times(const nodes::Animation& animation);

// The rate of `times` (increasing) if they are evenly spaced, snapped to a common rate if one
// matches within the precision of 32-bit floats and three printed decimals; nullopt otherwise or
// for fewer than two.
std::optional<double> even_rate(const std::vector<double>& times);

// The first common rate, most used first, for which all `times` are on frames counted from the
// first time.
std::optional<double> common_grid(const std::vector<double>& times);

}  // namespace krok::character
