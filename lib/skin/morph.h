#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/morph_set.h"

// Morph targets on the reference mesh. Morphing is applied before skinning: the result is the
// SkinSurface of skin().

namespace krok {

// Views of a mesh for skin.h and apply_morphs; non-owning.
struct MorphSurface {
  std::span<const Vec3f> positions;  // [vertices], metres
  std::span<const Vec3f> normals;    // [vertices] or empty
};
struct MorphedSurface {
  std::span<Vec3f> positions;
  std::span<Vec3f> normals;  // same size as the input
};

// v' = v + sum_i w_i (p_i - v) for each vertex of the model's mesh, over the targets of `morphs`
// with `weights` [targets]; weights may have any sign and any sum. Sums are computed in double and
// rounded once, so that a single target with weight 1 is reproduced exactly. Targets with weight 0
// are not read; if all are 0 the input is copied.
//
// Normals are blended too and normalised; one with length below 1e-15 or not finite is taken from
// the mesh. If `morphs` has no normals, the mesh normals are copied. Input and output must not
// overlap. Allocates nothing with one job; `jobs` as in parallel_for, the result does not depend
// on it.
void apply_morphs(const MorphSet& morphs, std::span<const float> weights, const MorphSurface& mesh,
                  const MorphedSurface& out, int jobs = 1);

// Morph weight animation: one keyed curve per target.

// Interpolation between keys.
enum class WeightJoin : unsigned char {
  linear,
  smooth,    // Hermite with tension; may overshoot
  monotone,  // Hermite without overshoot: PCHIP, see math/hermite.h
};

struct MorphCurve {
  std::vector<double> times;       // [keys] seconds, >= 0, strictly increasing
  std::vector<double> weights;     // [keys]
  std::vector<double> velocities;  // [keys] per second; empty: linear interpolation
};

// Computes the velocities of a curve with valid times and weights. `tension`, 0 to 1, as in
// tension_velocities(), is used by smooth joins only.
void join_keys(MorphCurve& curve, WeightJoin join, double tension = 0);

struct MorphCurves {
  std::vector<std::string> names;  // [targets] of a MorphSet
  std::vector<MorphCurve> curves;  // [targets]; a curve without keys is constant 0

  double duration() const;  // time of the last key of all curves, seconds; 0 without keys
};

// Checks the requirements above, and that all numbers are finite. Code morph-curve.
Status check(const MorphCurves& curves);

// Constant before the first key and after the last; exact at key times.
double weight_at(const MorphCurve& curve, double time);

// The number of frames at `rate` that cover all curves from 0 to the last key, rounded up. An Error
// (code morph-too-long) for more than 10 million.
Result<int> frames_of(const MorphCurves& curves, double rate);

// The weights at i / rate for i = 0 .. frames - 1. Codes: those of check(), morph-rate (not within
// kMinRate to kMaxRate of scene/clip.h), morph-too-long (more than 100 million weights in
// all).
Result<MorphWeights> sample(const MorphCurves& curves, double rate, int frames);

}  // namespace krok
