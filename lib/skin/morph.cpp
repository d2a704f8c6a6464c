#include "skin/morph.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/parallel.h"
#include "math/hermite.h"
#include "scene/clip.h"

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

namespace {

constexpr double kMaxFrames = 10e6;
constexpr double kMaxWeights = 100e6;

bool all_finite(const std::vector<double>& numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

Status check_curve(const MorphCurve& curve, const std::string& name) {
  const auto fault = [&](const char* what) {
    return Error("morph-curve", fmt::format("the weights of {} {}", name, what));
  };
  const std::size_t keys = curve.times.size();
  if (curve.weights.size() != keys ||
      (!curve.velocities.empty() && curve.velocities.size() != keys)) {
    return fault("have different numbers of times and values");
  }
  if (!all_finite(curve.times) || !all_finite(curve.weights) || !all_finite(curve.velocities)) {
    return fault("contain a value that is not finite");
  }
  if (keys > 0 && curve.times[0] < 0) return fault("start before time 0");
  const auto not_later = [](double before, double after) { return !(after > before); };
  if (std::ranges::adjacent_find(curve.times, not_later) != curve.times.end()) {
    return fault("have times that are not increasing");
  }
  return {};
}

}  // namespace

void join_keys(MorphCurve& curve, WeightJoin join, double tension) {
  curve.velocities.clear();
  if (join == WeightJoin::linear) return;
  curve.velocities.resize(curve.times.size());
  if (join == WeightJoin::smooth) {
    tension_velocities(curve.times, curve.weights, tension, Ends::open, curve.velocities);
  } else {
    monotone_velocities(curve.times, curve.weights, Ends::open, curve.velocities);
  }
}

double MorphCurves::duration() const {
  double last = 0;
  for (const MorphCurve& curve : curves) {
    if (!curve.times.empty()) last = std::max(last, curve.times.back());
  }
  return last;
}

Status check(const MorphCurves& curves) {
  if (curves.curves.size() != curves.names.size()) {
    return Error("morph-curve", fmt::format("{} curves for {} targets", curves.curves.size(),
                                            curves.names.size()));
  }
  for (std::size_t i = 0; i < curves.curves.size(); ++i) {
    if (Status status = check_curve(curves.curves[i], curves.names[i]); !status) return status;
  }
  return {};
}

double weight_at(const MorphCurve& curve, double time) {
  if (curve.times.empty()) return 0;
  if (!curve.velocities.empty()) {
    return sample_curve(curve.times, curve.weights, curve.velocities, time);
  }
  if (!(time > curve.times.front())) return curve.weights.front();
  if (time >= curve.times.back()) return curve.weights.back();
  const std::size_t k = key_before(curve.times, time);
  const double t = (time - curve.times[k]) / (curve.times[k + 1] - curve.times[k]);
  return curve.weights[k] + t * (curve.weights[k + 1] - curve.weights[k]);
}

Result<int> frames_of(const MorphCurves& curves, double rate) {
  if (Status status = check(curves); !status) return status.error();
  if (Status status = check_frame_rate(rate, "morph-rate"); !status) return status.error();
  // Tolerates rounding that puts the last key just after a frame.
  const double frames = std::ceil(curves.duration() * rate - 1e-6) + 1;
  if (frames <= kMaxFrames) return static_cast<int>(frames);
  return Error("morph-too-long", fmt::format("the weights last {} s, which is {} frames: too many",
                                             curves.duration(), frames));
}

Result<MorphWeights> sample(const MorphCurves& curves, double rate, int frames) {
  assert(frames >= 0);
  if (Status status = check(curves); !status) return status.error();
  if (Status status = check_frame_rate(rate, "morph-rate"); !status) return status.error();
  const std::size_t targets = curves.names.size();
  if (static_cast<double>(frames) * static_cast<double>(targets) > kMaxWeights) {
    return Error("morph-too-long",
                 fmt::format("{} frames of {} target weights exceed the limit", frames, targets));
  }
  MorphWeights weights;
  weights.rate = rate;
  weights.names = curves.names;
  weights.values.reserve(static_cast<std::size_t>(frames) * targets);
  for (int frame = 0; frame < frames; ++frame) {
    for (const MorphCurve& curve : curves.curves) {
      weights.values.push_back(static_cast<float>(weight_at(curve, frame / rate)));
    }
  }
  return weights;
}

}  // namespace krok
