#include "skin/morph.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/parallel.h"

namespace krok {

namespace {

constexpr std::size_t kSumTile =
    256;  // vertices whose sums stay in the cache from target to target

struct Morphing {
  const MorphSet& morphs;
  std::span<const float> weights;
  bool moves;  // whether any weight is not 0
};

// `mesh` plus the weighted differences of target positions or normals; target(i) returns the values
// of target i.
template <class Target, class Finish>
void morph_tile(const Morphing& morphing, std::span<const Vec3f> mesh, std::size_t begin,
                std::size_t end, const Target& target, const Finish& finish) {
  std::array<Vec3, kSumTile> sums;
  for (std::size_t v = begin; v < end; ++v) sums[v - begin] = mesh[v].cast<double>();
  for (std::size_t i = 0; i < morphing.weights.size(); ++i) {
    const double weight = morphing.weights[i];
    if (weight == 0) continue;
    const std::span<const Vec3f> to = target(static_cast<int>(i));
    for (std::size_t v = begin; v < end; ++v) {
      sums[v - begin] += weight * (to[v].cast<double>() - mesh[v].cast<double>());
    }
  }
  for (std::size_t v = begin; v < end; ++v) finish(v, sums[v - begin]);
}

void run_tile(const Morphing& morphing, const MorphSurface& mesh, const MorphedSurface& out,
              std::size_t begin, std::size_t end) {
  const MorphSet& morphs = morphing.morphs;
  if (morphing.moves) {
    morph_tile(
        morphing, mesh.positions, begin, end, [&](int i) { return morphs.target_positions(i); },
        [&](std::size_t v, const Vec3& sum) { out.positions[v] = sum.cast<float>(); });
  } else {
    std::copy(mesh.positions.begin() + begin, mesh.positions.begin() + end,
              out.positions.begin() + begin);
  }
  if (mesh.normals.empty()) return;
  if (morphing.moves && !morphs.normals.empty()) {
    morph_tile(
        morphing, mesh.normals, begin, end, [&](int i) { return morphs.target_normals(i); },
        [&](std::size_t v, const Vec3& sum) {
          const double length = sum.norm();
          const bool regular = std::isfinite(length) && length >= 1e-15;
          out.normals[v] = regular ? Vec3f((sum / length).cast<float>()) : mesh.normals[v];
        });
  } else {
    std::copy(mesh.normals.begin() + begin, mesh.normals.begin() + end,
              out.normals.begin() + begin);
  }
}

}  // namespace

void apply_morphs(const MorphSet& morphs, std::span<const float> weights, const MorphSurface& mesh,
                  const MorphedSurface& out, int jobs) {
  const std::size_t count = mesh.positions.size();
  assert(weights.size() == static_cast<std::size_t>(morphs.target_count()));
  assert(weights.empty() || count == static_cast<std::size_t>(morphs.vertex_count));
  assert(out.positions.size() == count && out.normals.size() == mesh.normals.size());
  const bool moves = std::any_of(weights.begin(), weights.end(), [](float w) { return w != 0; });
  const Morphing morphing{morphs, weights, moves};
  const auto tile = [&](std::size_t begin, std::size_t end) {
    run_tile(morphing, mesh, out, begin, end);
  };
  if (jobs == 1) {
    for (std::size_t v = 0; v < count; v += kSumTile) tile(v, std::min(v + kSumTile, count));
  } else {
    parallel_for(count, kSumTile, jobs, tile);
  }
}

}  // namespace krok
