#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "core/parallel.h"
#include "math/window.h"
#include "settle/settler_internal.h"

namespace krok::settling {

namespace {

constexpr double kAhead = 0.12;     // seconds
constexpr double kOverhang = 0.03;  // metres below what its part rests on where a point is free

}  // namespace

// Where on the ground each point belongs: over the place that it has in the source, which does not
// change as the solution goes on, so that no part is drawn to and fro over an edge.
void Settler::set_targets() {
  const auto count = at(frames());
  targets_.resize(count * points_.size());
  // What each part rests on: how far it is to rise, and which of its points does the most.
  std::vector<double> rests(bodies_.size() * count, std::numeric_limits<double>::quiet_NaN());
  std::vector<std::size_t> resting(rests.size(), 0);
  parallel_for(count, 16, options_.jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const std::vector<Transform> source = pose_of(source_, static_cast<int>(f));
      for (std::size_t p = 0; p < points_.size(); ++p) {
        const std::size_t i = f * points_.size() + p, b = at(points_[p].body);
        Target& target = targets_[i];
        target.place = source[at(bodies_[b].joint)] * points_[p].centre;
        const double height = over_rest(points_[p], target.place, static_cast<int>(f));
        if (!(weights_[i] > 1e-3) || !std::isfinite(height)) continue;
        target.weight = weights_[i] * weights_[i];
        target.rise = goals_[i] - height;
        target.slope = slope_under(points_[p], target.place, static_cast<int>(f));
        double& rest = rests[b * count + f];
        if (weights_[i] < 0.3 || rest > target.rise) continue;
        rest = target.rise;
        resting[b * count + f] = p;
      }
    }
  });
  const auto rest_of = [&](std::size_t b, std::size_t f) -> const Target& {
    return targets_[f * points_.size() + resting[b * count + f]];
  };
  // How far the ground under a part is below a plane through what a part next to it rests on.
  const auto step_below = [&](std::size_t b, std::size_t next, std::size_t f) {
    if (!touches(next, f) || std::isnan(rests[next * count + f])) return 0.0;
    const Target& own = rest_of(b, f);
    const Target& other = rest_of(next, f);
    return rests[next * count + f] - rests[b * count + f] +
           0.5 * (own.slope + other.slope).dot(own.place - other.place);
  };
  hangs_.assign(rests.size(), 0);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t f = 0; f < count; ++f) {
      if (std::isnan(rests[b * count + f])) continue;
      for (std::size_t next = 0; next < bodies_.size(); ++next) {
        if (bodies_[b].parent != static_cast<int>(next) &&
            bodies_[next].parent != static_cast<int>(b)) {
          continue;
        }
        const double step = step_below(b, next, f);
        if (step > kStep * scale_) hangs_[b * count + f] = std::max(hangs_[b * count + f], step);
      }
    }
  }
  // Parts that do not touch are raised ahead of a step.
  const int reach = std::max(1, static_cast<int>(std::lround(kAhead * rooted_.rate)));
  std::vector<double> steps(count, 0);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto own = std::span<double>(rests).subspan(b * count, count);
    for (std::size_t f = 1; f < count; ++f) {
      steps[f] = steps[f - 1];
      if (std::isnan(own[f]) || std::isnan(own[f - 1])) continue;
      const Target& before = rest_of(b, f - 1);
      const Target& now = rest_of(b, f);
      const double step =
          own[f] - own[f - 1] - 0.5 * (before.slope + now.slope).dot(now.place - before.place);
      if (std::abs(step) > kStep * scale_) steps[f] += step;
    }
    const auto soft = mean_within(mean_within(max_within(steps, 2 * reach), reach), reach);
    for (std::size_t f = 0; f < count; ++f) {
      if (std::isnan(own[f])) continue;
      const double moves = 1 - std::min(1.0, over_source_.touches[b].weight[f]);
      const Target& rest = rest_of(b, f);
      for (std::size_t p = points_of_[b].first; p < points_of_[b].second; ++p) {
        Target& target = targets_[f * points_.size() + p];
        const double plane = own[f] + rest.slope.dot(target.place - rest.place);
        const double hangs =
            std::max(0.0, plane + hangs_[b * count + f] - target.rise) / (kOverhang * scale_);
        target.weight /= (1 + hangs * hangs) * (1 + hangs * hangs);
        target.rise += moves * (soft[f] - steps[f]);
      }
    }
  }
}

}  // namespace krok::settling
