#include "face/mix.h"

#include <algorithm>
#include <memory>

namespace krok::face {

namespace {

constexpr double kMaxWeights = 100e6;

double strength_at(const Item& item, double time) {
  if (time < item.start || time > item.end) return 0;
  double strength = item.weight.at(time - item.start);
  if (item.fade_in.duration > 0) {
    strength *= item.fade_in.easing.at((time - item.start) / item.fade_in.duration);
  }
  if (item.fade_out.duration > 0) {
    strength *= item.fade_out.easing.at((item.end - time) / item.fade_out.duration);
  }
  return strength;
}

}  // namespace

Item item_of(MorphCurves curves) {
  Item item;
  for (const MorphCurve& curve : curves.curves) item.has.push_back(curve.times.empty() ? 0 : 1);
  item.at = [shared = std::make_shared<const MorphCurves>(std::move(curves))](
                double seconds, std::span<double> weights) {
    for (std::size_t t = 0; t < weights.size(); ++t) {
      weights[t] = weight_at(shared->curves[t], seconds);
    }
  };
  return item;
}

Result<MorphWeights> mix(std::span<const std::string> targets, std::span<const Item> items,
                         double rate, int frames) {
  if (static_cast<double>(targets.size()) * frames > kMaxWeights) {
    return Error("morph-too-long", "the face has more than 100 million weights");
  }
  MorphWeights mixed;
  mixed.rate = rate;
  mixed.names.assign(targets.begin(), targets.end());
  std::vector<double> sum(targets.size()), own(targets.size());
  for (int frame = 0; frame < frames; ++frame) {
    const double time = frame / rate;
    std::ranges::fill(sum, 0.0);
    for (const Item& item : items) {
      const double strength = strength_at(item, time);
      if (strength == 0) continue;
      std::ranges::fill(own, 0.0);
      item.at(time - item.start, own);
      for (std::size_t t = 0; t < sum.size(); ++t) {
        if (item.has[t] == 0) continue;
        sum[t] = (item.additive ? sum[t] : (1 - strength) * sum[t]) + strength * own[t];
      }
    }
    for (const double weight : sum) mixed.values.push_back(static_cast<float>(weight));
  }
  return mixed;
}

}  // namespace krok::face
