#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "math/transform.h"
#include "scene/model.h"
#include "skin/palette.h"

// CPU skinning in three steps: a SkinBinding once per model, a SkinPose once per frame, and skin()
// to transform the vertices of the mesh, or of a morphed one. Only the constructors of SkinBinding
// and SkinPose allocate memory, and skin() with more than one job.
//
// With the palette P_i = M_i C_i^-1 (palette.h), position v, normal n and tangent t:
//
//   rigid            v' = P_k v with k the strongest joint of the vertex
//   linear           v' = B v, B = sum_i w_i P_i. Loses volume where joints twist (the candy
//                    wrapper effect: half-way between two joints twisted by an angle a, a radius r
//                    becomes r cos(a/2)). Source: Magnenat-Thalmann, Laperriere, Thalmann,
//                    Joint-Dependent Local Deformations (Graphics Interface 1988).
//   dual quaternion  P_i as the unit dual quaternion q_i, s_i = -1 if q_i and that of the vertex's
//                    first joint are in different hemispheres (dot product of the real parts < 0),
//                    else 1: v' is v transformed by the normalised sum_i s_i w_i q_i. The blend is
//                    rigid, so twists keep the radius. Source: Kavan, Collins, Zara, O'Sullivan,
//                    Geometric Skinning with Approximate Dual Quaternion Blending (ACM TOG 27(4),
//                    2008). Matrices with scale or shear are split (palette.h): the
//                    deformations are blended linearly and applied before the rigid transforms.
//   spherical        v' = Q (v - r) + sum_i w_i P_i r, with Q the rotation of the normalised sum_i
//                    s_i w_i q_i, and r the rotation centre of the vertex's set of joints: that
//                    which the P_i move to places as near to each other as possible, by least
//                    squares over all pairs; of several the nearest to the mean of the joints after
//                    the first in the reference pose. For two joined bones it is their joint.
//                    Source: Kavan, Zara, Spherical Blend Skinning (I3D 2005). Deformations as
//                    above. Not vectorised; surfaces may step where sets of joints change.
//
// Normals and tangents are transformed by the same map without its translation and normalised. If
// the palette is not rigid, normals use the inverse transpose of the blended matrix, so that they
// stay perpendicular to the surface as long as weights change slowly, and a reflection flips the
// tangents' handedness; for rigid palettes they use B itself, as is usual. A result with length
// below 1e-15 (opposing influences, a zero normal) or not finite is replaced by the transform of
// the vertex's first joint alone; if that fails too, a normal is +Y and a tangent +X.
//
// With palette matrices that are exactly the identity, positions are unchanged to the bit (rigid
// and dual quaternion for any weights, linear if the float sum of the weights is 1). A palette
// matrix with NaN makes only the vertices that it influences NaN.
//
// Results are bit-identical for the reference and the kernels, on AVX2 and AVX-512, and for any
// number of threads: all do the same fused multiply-adds in the same order. A machine without FMA
// runs the reference, with std::fma from the C library.

namespace krok {

enum class SkinMethod : unsigned char { rigid, linear, dual_quaternion, spherical };

namespace skin_detail {
struct Binding;
struct Posed;
}  // namespace skin_detail

// The pose-independent part of a model's skin, in the layout that the kernels read: influences with
// zero weight are removed, and for dual quaternions each pair of a vertex's first joint and another
// is numbered, so that the hemisphere test is done per pair and not per vertex. Vertices keep the
// model's order: sorting them by joint would speed up blending, but restoring the order costs more
// than that saves. Can be shared between threads.
class SkinBinding {
 public:
  // `model` must pass check(), except for the sums of weights: if they are not 1, linear blend uses
  // B unnormalised, and the other methods do not depend on it. Negative and NaN weights count as 0.
  // A vertex without weights follows its first listed joint.
  SkinBinding(const Model& model, SkinMethod method);
  SkinBinding(SkinBinding&&) noexcept;
  SkinBinding& operator=(SkinBinding&&) noexcept;
  ~SkinBinding();

  SkinMethod method() const;
  std::size_t vertex_count() const;
  std::size_t joint_count() const;
  const skin_detail::Binding& data() const { return *data_; }  // internal

 private:
  std::unique_ptr<const skin_detail::Binding> data_;
};

// A pose in the layout of a binding's method. Use one per thread that sets poses; the binding must
// be alive while it is set and used.
class SkinPose {
 public:
  explicit SkinPose(const SkinBinding& binding);  // the reference pose
  SkinPose(SkinPose&&) noexcept;
  SkinPose& operator=(SkinPose&&) noexcept;
  ~SkinPose();

  // All take [joints] elements and allocate nothing: a pose of a clip, one with stretches (none for
  // rigid joints), or a palette of arbitrary matrices; their last row is taken as 0 0 0 1.
  void set(std::span<const Transform> joint_to_world);
  void set(std::span<const Transform> joint_to_world, std::span<const Stretch> stretches);
  void set_palette(std::span<const SkinMatrix> palette);

  const skin_detail::Posed& data() const { return *data_; }  // internal

 private:
  template <typename MatrixOf>
  void set_matrices(const MatrixOf& matrix_of);

  std::unique_ptr<skin_detail::Posed> data_;
};

// The input surface, in the reference pose; non-owning. Normals and tangents may be empty.
struct SkinSurface {
  std::span<const Vec3f> positions;  // [vertices], metres
  std::span<const Vec3f> normals;    // [vertices], any length
  std::span<const Vec4f> tangents;   // [vertices], xyz of any length, w = +1 or -1
};

// Views into the surface of a model.
SkinSurface skin_surface(const Model& model);

// The output surface: same sizes as the input. Must not overlap the input.
struct SkinnedSurface {
  std::span<Vec3f> positions;
  std::span<Vec3f> normals;   // unit
  std::span<Vec4f> tangents;  // unit xyz
};

// Transforms the vertices with the kernel for the best instruction set of the machine, on up to
// `jobs` threads (0: one per core; 1 allocates nothing).
void skin(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
          const SkinnedSurface& out, int jobs = 1);

// As skin(), by the scalar reference that the kernels are tested against.
void skin_reference(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
                    const SkinnedSurface& out);

}  // namespace krok
