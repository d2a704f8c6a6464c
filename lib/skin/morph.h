#pragma once

#include <span>

#include "math/types.h"
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

}  // namespace krok
