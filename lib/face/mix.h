#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "blend/time_map.h"
#include "core/result.h"
#include "scene/morph_set.h"
#include "skin/morph_curves.h"
#include "timeline/timeline.h"

// Several animations of a face, one above the other, as morph weights over time.

namespace krok::face {

struct Item {
  // Sets the weights of the targets that it has, [targets], at a time since its start.
  std::function<void(double seconds, std::span<double> weights)> at;
  std::vector<char> has;      // [targets] 1: it moves this one
  double start = 0, end = 0;  // seconds of the result
  timeline::Fade fade_in, fade_out;
  blend::WeightCurve weight = blend::WeightCurve::constant(1);  // over seconds since its start
  bool additive = false;  // adds to what is below; otherwise replaces it
};

// Of curves for targets of the same names; those with keys are moved. The curves are copied.
Item item_of(MorphCurves curves);

// Weights of frames 0 to frames - 1. Items are applied in their order: with a strength s of fades
// and weight, one that replaces gives (1 - s) below + s own, as cross-fades of motions do. Code
// morph-too-long for more than 100 million weights.
Result<MorphWeights> mix(std::span<const std::string> targets, std::span<const Item> items,
                         double rate, int frames);

}  // namespace krok::face
