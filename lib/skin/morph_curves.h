#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "scene/morph_set.h"

// Weights of morph targets through keys at times of their own, a curve a target.

namespace krok {

// How a weight gets from one key to the next.
enum class WeightJoin : unsigned char {
  linear,    // straight and evenly
  smooth,    // Hermite with a tension; may go beyond its keys
  monotone,  // Hermite that never does: PCHIP, see math/hermite.h
};

struct MorphCurve {
  std::vector<double> times;       // [keys] seconds from 0, rising strictly
  std::vector<double> weights;     // [keys]
  std::vector<double> velocities;  // [keys] a second; none: straight between keys
};

// Fills in the velocities of a curve whose times and weights are right. `tension`, 0 to 1, is that
// of tension_velocities() and for smooth joins alone.
void join_keys(MorphCurve& curve, WeightJoin join, double tension = 0);

struct MorphCurves {
  std::vector<std::string> names;  // [targets], a MorphSet's
  std::vector<MorphCurve> curves;  // [targets]; one without keys is 0 all the time

  double duration() const;  // the time of the last key of all, in seconds; 0 without keys
};

// Whether what the comments above promise holds, and all numbers are finite. Code morph-curve.
Status check(const MorphCurves& curves);

// Before its first key a curve has the first one's weight, after its last the last one's. At a
// key's time exactly the key.
double weight_at(const MorphCurve& curve, double time);

// How many frames at `rate` hold all of the curves: from 0 to the last key, and where that falls
// between two frames one more. An Error (code morph-too-long) for more than 10 million.
Result<int> frames_of(const MorphCurves& curves, double rate);

// The weights at i / rate for i = 0 .. frames - 1. Codes: those of check(), morph-rate (not within
// 0.001 to 1,000,000), morph-too-long (more than 100 million weights in all).
Result<MorphWeights> sample(const MorphCurves& curves, double rate, int frames);

}  // namespace krok
