#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/parallel.h"
#include "math/hermite.h"
#include "scene/frame_blocks.h"
#include "settle/settler_internal.h"

namespace krok::settling {

// Where on the ground each point belongs: over the place that it has in the source, which does not
// change as the solution goes on, so that no part is drawn to and fro over an edge. Frames of the
// stretch before keep their targets.
void Settler::set_targets(int first, int last) {
  const auto clip = load(part_of(rooted_, first, last - first + 1), options_.jobs);
  if (!clip) {
    status_ = clip.error();
    return;
  }
  const std::size_t size = points_.size(), known = at(stretch_first_ + stretch_.frames - first);
  std::move(targets_.end() - static_cast<std::ptrdiff_t>(known * size), targets_.end(),
            targets_.begin());
  targets_.resize(known * size);
  stretch_first_ = first;
  stretch_ = local_motion(*clip);
  targets_.resize(at(stretch_.frames) * size);
  const auto count = at(frames());
  parallel_for(at(stretch_.frames) - known, 16, options_.jobs, [&](std::size_t from, auto to) {
    for (std::size_t i = known + from; i < known + to; ++i) {
      const std::vector<Transform> source = pose_of(stretch_, static_cast<int>(i));
      const int frame = first + static_cast<int>(i);
      for (std::size_t p = 0; p < size; ++p) {
        const SupportPoint& point = points_[p];
        const std::size_t b = at(point.body);
        Target& target = targets_[i * size + p];
        target.place = source[at(bodies_[b].joint)] * point.centre;
        const double height = over_rest(point, target.place, frame);
        const double before = follows_ground_ ? height : target.place.y() - point.radius - floor_;
        const double goal = std::max(0.0, before + raised_[b * count + at(frame)]);
        const double weight = 1 - smoother_step(goal / (kFar * scale_));
        if (!(weight > 1e-3) || !std::isfinite(height)) continue;
        target.weight = weight * weight;
        target.rise = goal - height;
        target.slope = slope_under(point, target.place, frame);
      }
    }
  });
}

}  // namespace krok::settling
