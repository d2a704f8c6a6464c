#include "skin/skin_job_internal.h"

#include <algorithm>

#include "core/parallel.h"

namespace krok::skin_detail {

void over_tiles(Kernel kernel, const Job& job, std::size_t count, int jobs) {
  // A few tiles per thread, to balance load; not more, because each tile restarts the hardware
  // prefetcher. Small meshes run on one thread.
  constexpr std::size_t kMin = 128 * kBlock;
  constexpr std::size_t kTilesAThread = 4;
  const std::size_t threads = static_cast<std::size_t>(thread_count(jobs));
  if (threads == 1 || count <= kMin) return kernel(job, 0, count);
  const std::size_t blocks = count / kBlock / (kTilesAThread * threads);
  parallel_for(count, std::max(kMin, blocks * kBlock), jobs,
               [&](std::size_t begin, std::size_t end) { kernel(job, begin, end); });
}

Run run_from(const Influences& influences, std::size_t begin, std::size_t end) {
  if (influences.blocks == nullptr) {
    return {end, begin * influences.influences, influences.influences};
  }
  const Block& block = influences.blocks[begin / kBlock];
  std::size_t v = begin + kBlock;
  while (v < end && influences.blocks[v / kBlock].influences == block.influences) v += kBlock;
  return {std::min(v, end), block.first, block.influences};
}

namespace {

// Copies items `begin` to `end` of `size` numbers each to `to`, and repeats the last up to kBlock.
template <class T>
const T* padded(const T* from, std::size_t begin, std::size_t end, std::size_t size, T* to) {
  if (from == nullptr) return nullptr;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const T* item = from + std::min(begin + i, end - 1) * size;
    std::copy_n(item, size, to + i * size);
  }
  return to;
}

}  // namespace

Tail::Tail(const Job& job, std::size_t begin, std::size_t end)
    : whole_(job), begin_(begin), count_(end - begin), tail_(job) {
  const Run run = run_from(job.influences, begin, end);
  const auto from = [&](auto* values) { return values == nullptr ? nullptr : values + run.first; };
  tail_.influences.joints = padded(from(job.influences.joints), 0, count_, run.influences, joints_);
  tail_.influences.pairs = padded(from(job.influences.pairs), 0, count_, run.influences, pairs_);
  tail_.influences.weights =
      padded(from(job.influences.weights), 0, count_, run.influences, weights_);
  tail_.influences.influences = run.influences;
  tail_.influences.blocks = nullptr;
  tail_.positions = padded(job.positions, begin, end, 3, positions_);
  tail_.normals = padded(job.normals, begin, end, 3, normals_);
  tail_.tangents = padded(job.tangents, begin, end, 4, tangents_);
  tail_.out_positions = out_positions_;
  tail_.out_normals = out_normals_;
  tail_.out_tangents = out_tangents_;
}

void Tail::copy_back() const {
  std::copy_n(out_positions_, 3 * count_, whole_.out_positions + 3 * begin_);
  if (whole_.normals != nullptr) {
    std::copy_n(out_normals_, 3 * count_, whole_.out_normals + 3 * begin_);
  }
  if (whole_.tangents != nullptr) {
    std::copy_n(out_tangents_, 4 * count_, whole_.out_tangents + 4 * begin_);
  }
}

}  // namespace krok::skin_detail
