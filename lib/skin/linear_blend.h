#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "math/types.h"
#include "scene/model.h"
#include "skin/palette.h"

// Linear blend skinning on the CPU: v' = sum_i w_i P_i v with the palette P_i = M_i C_i^-1, the
// same without translation for normals, which come out with length 1. Source: Magnenat-Thalmann,
// Laperriere, Thalmann, Joint-Dependent Local Deformations (Graphics Interface 1988).
//
// Every function here gives the same bytes: the reference and the SIMD kernel, on AVX2 and AVX-512,
// and for every number of threads. All do the same fused multiply-adds in the same order; a machine
// without fused arithmetic runs the reference, which then has it done by the C library.

namespace krok {

// What is skinned. Nothing is owned, nothing may overlap the output.
struct SkinVertices {
  std::span<const Vec3f> positions;       // [vertices], metres, in the reference pose
  std::span<const Vec3f> normals;         // [vertices] or empty; any length
  int influences_per_vertex = 4;          // 1 .. Model::kMaxInfluences
  std::span<const std::uint16_t> joints;  // [vertices x influences_per_vertex], all in the palette
  std::span<const float> weights;         // the same shape; sum to 1 for each vertex
};

// The vertices of a model; views into it.
SkinVertices skin_vertices(const Model& model);

// Where the result goes; the caller owns the memory. Normals are empty exactly if the input's are.
struct SkinnedVertices {
  std::span<Vec3f> positions;  // [vertices]
  std::span<Vec3f> normals;    // [vertices] or empty; unit
};

// A blended normal of length under 1e-15 (opposing influences, a zero normal) or that is not finite
// becomes what its first influence alone makes of it; failing that too, +Y.
//
// The scalar reference: what the others are held against.
void linear_blend_reference(std::span<const SkinMatrix> palette, const SkinVertices& in,
                            SkinnedVertices out);

// The SIMD kernel, for the best instruction set that the machine has. Allocates nothing.
void linear_blend(std::span<const SkinMatrix> palette, const SkinVertices& in, SkinnedVertices out);

// The SIMD kernel over tiles of vertices on up to `jobs` threads (0: one a core).
void linear_blend_parallel(std::span<const SkinMatrix> palette, const SkinVertices& in,
                           SkinnedVertices out, int jobs);

}  // namespace krok
