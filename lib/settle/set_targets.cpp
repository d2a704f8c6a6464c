#include <cmath>

#include "core/index.h"
#include "core/parallel.h"
#include "settle/settler_internal.h"

namespace krok::settling {

// Where on the ground each point belongs: over the place that it has in the source, which does not
// change as the solution goes on, so that no part is drawn to and fro over an edge.
void Settler::set_targets() {
  const auto count = at(frames());
  targets_.resize(count * points_.size());
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
      }
    }
  });
}

}  // namespace krok::settling
