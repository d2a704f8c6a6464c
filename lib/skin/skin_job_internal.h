#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "skin/palette.h"
#include "skin/skin.h"

// Shared by the scalar references and the SIMD kernels. No inline functions here: the kernels are
// compiled for several instruction sets, and the linker keeps one copy of an inline function,
// perhaps one that the machine cannot run.

namespace krok::skin_detail {

// Vertices per block (the last block may be shorter). The influences of a block are contiguous.
inline constexpr std::size_t kBlock = 16;

struct Block {
  std::size_t first;       // index of its first influence
  std::size_t influences;  // per vertex
};

// The influences of the vertices. Without blocks, influence k of vertex v is at
// v * influences + k; with blocks, at first + (v % kBlock) * influences + k of block v / kBlock.
struct Influences {
  const std::uint16_t* joints = nullptr;
  const std::uint32_t* pairs = nullptr;  // for dual quaternions, else null; indexed as `joints`
  const float* weights = nullptr;
  std::size_t influences = 0;
  const Block* blocks = nullptr;
};

// Vertices are floats, three per position and normal, four per tangent; normals and tangents may be
// null.
struct Job {
  Influences influences;
  const SkinMatrix* palette = nullptr;      // by joint; for dual quaternions the deformations,
                                            // null if all matrices are rigid
  const DualQuaternion* motions = nullptr;  // by pair; null for linear blend
  const Vec3f* centres = nullptr;           // by pair; of spherical blend alone, whose motions are
                                            // the rotation and where it moves the centre
  bool inverse_transpose = false;           // transform normals by the inverse transpose
  const float* positions = nullptr;
  const float* normals = nullptr;
  const float* tangents = nullptr;
  float* out_positions = nullptr;
  float* out_normals = nullptr;
  float* out_tangents = nullptr;
};

// Squared lengths within which a vector can be normalised. NaN is outside.
inline constexpr float kMinLengthSquared = 1e-30f;
inline constexpr float kMaxLengthSquared = 1e30f;

// Scalar references for vertices [begin, end).
void linear_scalar(const Job& job, std::size_t begin, std::size_t end);
void dual_quaternion_scalar(const Job& job, std::size_t begin, std::size_t end);

// SIMD kernels for the best instruction set of the machine; `begin` is a multiple of kBlock, `end`
// is too or is the number of vertices.
void linear_simd(const Job& job, std::size_t begin, std::size_t end);
void dual_quaternion_simd(const Job& job, std::size_t begin, std::size_t end);

// Runs a kernel over tiles of `count` vertices on up to `jobs` threads; 1 allocates nothing.
using Kernel = void (*)(const Job& job, std::size_t begin, std::size_t end);
void over_tiles(Kernel kernel, const Job& job, std::size_t count, int jobs);

// A run of whole blocks with the same number of influences per vertex, contiguous from `first`.
struct Run {
  std::size_t end;
  std::size_t first;
  std::size_t influences;
};
Run run_from(const Influences& influences, std::size_t begin, std::size_t end);

// The last vertices of a job, fewer than a kernel processes at once, as a job of kBlock vertices:
// padded with copies of the last one.
class Tail {
 public:
  Tail(const Job& job, std::size_t begin, std::size_t end);
  const Job& job() const { return tail_; }
  void copy_back() const;

 private:
  static constexpr std::size_t kMaxInfluences = 8;
  const Job& whole_;
  std::size_t begin_, count_;
  Job tail_;
  std::uint16_t joints_[kBlock * kMaxInfluences];
  std::uint32_t pairs_[kBlock * kMaxInfluences];
  float weights_[kBlock * kMaxInfluences];
  float positions_[kBlock * 3], normals_[kBlock * 3], tangents_[kBlock * 4];
  float out_positions_[kBlock * 3], out_normals_[kBlock * 3], out_tangents_[kBlock * 4];
};

// The data of SkinBinding and SkinPose.

struct Pair {
  std::uint16_t first, joint;
};

struct Binding {
  SkinMethod method = SkinMethod::linear;
  std::size_t vertex_count = 0;
  std::vector<Transform> joint_to_world;      // in the reference pose
  std::vector<Transform> reference_to_joint;  // inverses of joint_to_world
  std::vector<Block> blocks;
  std::vector<std::uint16_t> joints;
  std::vector<std::uint32_t> pair_indices;  // dual quaternions only
  std::vector<float> weights;
  std::vector<Pair> pairs;
  std::vector<std::uint32_t> pair_sets;          // [pairs] spherical blend only
  std::vector<std::vector<std::uint16_t>> sets;  // of joints, in order; spherical blend only

  Influences influences() const;
};

struct Posed {
  const Binding* binding = nullptr;
  bool is_rigid = true;
  std::vector<SkinMatrix> palette;           // [joints]; for dual quaternions the deformations
  std::vector<DualQuaternion> motions;       // [joints]; dual quaternions and spherical blend
  std::vector<DualQuaternion> pair_motions;  // [pairs]
  std::vector<Vec3> set_centres;             // [sets]; spherical blend only
  std::vector<Vec3f> pair_centres;           // [pairs]; the same as floats
};

// Whether a method blends rotations rather than matrices.
constexpr bool blends_motions(SkinMethod method) {
  return method == SkinMethod::dual_quaternion || method == SkinMethod::spherical;
}

// Spherical blend: numbers the set of joints of each vertex, and its pairs; sets the motions of the
// pairs and the rotation centres.
class SetNumbers {
 public:
  explicit SetNumbers(Binding& binding) : binding_(binding) {}
  // The number of the set of some joints, and of the pair of a set and a joint in it.
  std::uint32_t set(std::vector<std::uint16_t> joints);
  std::uint32_t pair(std::uint32_t set, std::uint16_t joint);

 private:
  Binding& binding_;
  std::map<std::vector<std::uint16_t>, std::uint32_t> sets_;
  std::map<std::pair<std::uint32_t, std::uint16_t>, std::uint32_t> pairs_;
};
void fill_centres(Posed& pose);

}  // namespace krok::skin_detail
