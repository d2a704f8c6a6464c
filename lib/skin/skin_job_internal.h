#pragma once

#include <cstddef>
#include <cstdint>

#include "skin/dual_quaternion.h"
#include "skin/palette.h"

// What the scalar references and the SIMD kernels share: plain pointers, and the rare cases. No
// inline functions here: the kernels are compiled for several instruction sets, and the linker
// keeps one copy of an inline function, perhaps one that the machine cannot run.

namespace krok::skin_detail {

// Vertices come in blocks of this many, the last one perhaps shorter, whose influences lie
// together.
inline constexpr std::size_t kBlock = 16;

struct Block {
  std::size_t first;       // of its influences
  std::size_t influences;  // of each of its vertices
};

// Where the influences of vertices are: without blocks influence k of vertex v at
// v * influences + k, with blocks at first + (v % kBlock) * influences + k of block v / kBlock.
struct Influences {
  const std::uint16_t* joints = nullptr;
  const std::uint32_t* pairs = nullptr;  // for dual quaternions, else null; places as of `joints`
  const float* weights = nullptr;
  std::size_t influences = 0;
  const Block* blocks = nullptr;
};

// Vertices as floats, three each for positions and normals, four each for tangents; normals and
// tangents may be null.
struct Job {
  Influences influences;
  const SkinMatrix* palette = nullptr;      // by joint; for dual quaternions the part that is not
                                            // rigid, null where all is
  const DualQuaternion* motions = nullptr;  // by pair; null for linear blend
  bool inverse_transpose = false;           // how normals follow `palette`; without it as vectors
  const float* positions = nullptr;
  const float* normals = nullptr;
  const float* tangents = nullptr;
  float* out_positions = nullptr;
  float* out_normals = nullptr;
  float* out_tangents = nullptr;
};

// The squares of lengths between which a vector can be brought to length 1. NaN is outside.
inline constexpr float kMinLengthSquared = 1e-30f;
inline constexpr float kMaxLengthSquared = 1e30f;

// The references for vertices [begin, end).
void linear_scalar(const Job& job, std::size_t begin, std::size_t end);
void dual_quaternion_scalar(const Job& job, std::size_t begin, std::size_t end);

// The SIMD kernels for the best instruction set that the machine has; `begin` is a multiple of
// kBlock, `end` another or the last vertex.
void linear_simd(const Job& job, std::size_t begin, std::size_t end);
void dual_quaternion_simd(const Job& job, std::size_t begin, std::size_t end);

// A kernel over tiles of `count` vertices on up to `jobs` threads; 1 takes no memory.
using Kernel = void (*)(const Job& job, std::size_t begin, std::size_t end);
void over_tiles(Kernel kernel, const Job& job, std::size_t count, int jobs);

// Vertices in a row, a whole number of blocks, with the same number of influences each, which lie
// together from `first` on.
struct Run {
  std::size_t end;
  std::size_t first;
  std::size_t influences;
};
Run run_from(const Influences& influences, std::size_t begin, std::size_t end);

// The last vertices of a job, fewer than a kernel takes at once, as a job of kBlock vertices: the
// last one again and again behind them.
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

}  // namespace krok::skin_detail
