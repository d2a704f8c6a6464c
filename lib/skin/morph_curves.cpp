#include "skin/morph_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "math/hermite.h"
#include "scene/frame_moment.h"

namespace krok {

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
