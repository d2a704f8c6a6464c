#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "math/types.h"
#include "scene/model.h"
#include "skin/palette.h"

// Skinning on the CPU in three steps: a binding is made once for a model, a pose once a frame, and
// the vertices of the mesh, or of a morphed one, are moved by both. Where memory is taken: in
// binding and when a SkinPose is made, never in between.
//
// With the palette P_i = M_i C_i^-1 (palette.h), position v, normal n and tangent t:
//
//   rigid            v' = P_k v with k the strongest joint of the vertex
//   linear           v' = B v, B = sum_i w_i P_i. Where joints twist the surface loses volume (the
//                    candy wrapper: between two joints turned against each other by an angle a, a
//                    radius r becomes r cos(a/2)). Source: Magnenat-Thalmann, Laperriere, Thalmann,
//                    Joint-Dependent Local Deformations (Graphics Interface 1988).
//   dual quaternion  P_i as the unit dual quaternion q_i, s_i = -1 where q_i and the vertex's first
//                    joint's lie in different hemispheres (real parts' dot product < 0), else 1:
//                    v' is v moved by sum_i s_i w_i q_i brought to length 1. A rigid motion, so
//                    that twists keep the radius. Source: Kavan, Collins, Zara, O'Sullivan,
//                    Geometric Skinning with Approximate Dual Quaternion Blending (ACM TOG 27(4),
//                    2008). Matrices that scale or shear are split (dual_quaternion.h): the
//                    deformations are blended linearly and come first, the rigid motions second.
//
// Normals and tangents are moved by the same map without its translation and come out with length
// 1. Where matrices of the palette are not rigid, normals follow the inverse transpose of what is
// blended, so that they stay perpendicular to the surface as far as weights change slowly, and the
// handedness of tangents turns round where it mirrors; for rigid palettes they follow B itself, as
// is usual. One that has no length to speak of (under 1e-15: opposing influences, a zero normal) or
// is not finite becomes what the vertex's first joint alone makes of it; failing that too, a normal
// is +Y and a tangent +X.
//
// The palette of the reference pose changes no bit of positions where it is exactly the identity
// (rigid and dual quaternion for any weights, linear where the weights' sum in floats is 1).
// A palette with NaN makes the positions of the vertices that it moves NaN, no others.
//
// Every version gives the same bytes: the reference and the kernels, on AVX2 and AVX-512, and for
// every number of threads. All do the same fused multiply-adds in the same order; a machine without
// fused arithmetic runs the reference, which then has it done by the C library.

namespace krok {

enum class SkinMethod : unsigned char { rigid, linear, dual_quaternion };

namespace skin_detail {
struct Binding;
struct Posed;
}  // namespace skin_detail

// What of a model's skin stays the same in all poses, in the form that the kernels read: influences
// without weight are left out, and for dual quaternions the pairs of a vertex's first joint and
// another are numbered, so that the hemisphere rule is kept once a pair and not once a vertex.
// Vertices stay in the model's order: sorted by their joints they would blend faster, but bringing
// the result back into order costs more than that saves. May be shared between threads.
class SkinBinding {
 public:
  // `model` is as check() wants it, but for the sums of weights: where a vertex's do not sum to 1,
  // linear blend moves it by B as it stands, and the other methods do not notice. A negative weight
  // or NaN counts as none. A vertex without any weight follows the first joint named for it.
  SkinBinding(const Model& model, SkinMethod method);
  SkinBinding(SkinBinding&&) noexcept;
  SkinBinding& operator=(SkinBinding&&) noexcept;
  ~SkinBinding();

  SkinMethod method() const;
  std::size_t vertex_count() const;
  std::size_t joint_count() const;
  const skin_detail::Binding& data() const { return *data_; }  // for the library itself

 private:
  std::unique_ptr<const skin_detail::Binding> data_;
};

// A pose in the form that a binding's method needs. One for each thread that sets poses; needs the
// binding no longer than it is set and used with it.
class SkinPose {
 public:
  explicit SkinPose(const SkinBinding& binding);  // the reference pose
  SkinPose(SkinPose&&) noexcept;
  SkinPose& operator=(SkinPose&&) noexcept;
  ~SkinPose();

  // Both take [joints] elements and allocate nothing: the pose as a clip has it, or a palette with
  // whatever matrices, whose last rows count as 0 0 0 1.
  void set(std::span<const Transform> joint_to_world);
  void set_palette(std::span<const SkinMatrix> palette);

  const skin_detail::Posed& data() const { return *data_; }  // for the library itself

 private:
  std::unique_ptr<skin_detail::Posed> data_;
};

// What is skinned, in the reference pose; nothing is owned. Normals and tangents may be empty.
struct SkinSurface {
  std::span<const Vec3f> positions;  // [vertices], metres
  std::span<const Vec3f> normals;    // [vertices], any length
  std::span<const Vec4f> tangents;   // [vertices], xyz of any length, w = +1 or -1
};

// The surface of a model; views into it.
SkinSurface skin_surface(const Model& model);

// Where the result goes: as many as the input has of each. Must not overlap the input.
struct SkinnedSurface {
  std::span<Vec3f> positions;
  std::span<Vec3f> normals;   // unit
  std::span<Vec4f> tangents;  // unit xyz
};

// Moves the vertices: the kernel for the best instruction set that the machine has, over tiles of
// vertices on up to `jobs` threads (0: one a core; 1 allocates nothing).
void skin(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
          const SkinnedSurface& out, int jobs = 1);

// The same by the scalar reference, which the kernels are held against.
void skin_reference(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
                    const SkinnedSurface& out);

}  // namespace krok
