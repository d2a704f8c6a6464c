#pragma once

#include <span>

#include "math/types.h"
#include "scene/morph_set.h"

// Morph targets on the reference mesh. Morphing comes first and the skeleton second: the result is
// what skin() takes as its SkinSurface.

namespace krok {

// A mesh as skin.h and apply_morphs have it; nothing is owned.
struct MorphSurface {
  std::span<const Vec3f> positions;  // [vertices], metres
  std::span<const Vec3f> normals;    // [vertices] or empty
};
struct MorphedSurface {
  std::span<Vec3f> positions;
  std::span<Vec3f> normals;  // as many as the input has
};

// v' = v + sum_i w_i (p_i - v) for each vertex of the model's mesh, over the targets of `morphs`
// with `weights` [targets]; weights may have any sign and any sum. Sums are worked out in doubles
// and rounded once, so that one target with weight 1 comes out as it stands in the set. Targets of
// weight 0 are not read. Without any other, positions and normals come out as they are.
//
// Normals are summed likewise and brought to length 1; one that has no length to speak of (under
// 1e-15) or is not finite comes out as the mesh has it. Where `morphs` has no normals, the mesh's
// are copied. Input and output must not overlap. Allocates nothing with one job; `jobs` as in
// parallel_for, the same bytes for any.
void apply_morphs(const MorphSet& morphs, std::span<const float> weights, const MorphSurface& mesh,
                  const MorphedSurface& out, int jobs = 1);

}  // namespace krok
