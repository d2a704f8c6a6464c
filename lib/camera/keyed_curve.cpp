#include <algorithm>

#include "camera/keyed_curve_internal.h"

namespace krok {

std::vector<SmoothRun> smooth_runs(const KeyTimes& keys) {
  std::vector<SmoothRun> runs;
  const std::size_t count = keys.times.size();
  for (std::size_t first = 0; first + 1 < count;) {
    std::size_t last = first;
    while (last + 1 < count && keys.between[last] == Between::smooth) ++last;
    if (last > first) runs.push_back({first, last - first + 1});
    first = std::max(last, first + 1);
  }
  return runs;
}

Moment moment_at(const KeyTimes& keys, double time) {
  Moment moment;
  moment.key = key_before(keys.times, time);
  const bool within = moment.key + 1 < keys.times.size() && time > keys.times[moment.key];
  if (!within) return moment;
  moment.span = keys.times[moment.key + 1] - keys.times[moment.key];
  const double t = (time - keys.times[moment.key]) / moment.span;
  switch (keys.between[moment.key]) {
    case Between::smooth:
      moment.smooth = true;
      moment.t = t;
      break;
    case Between::linear:
      moment.t = t;
      break;
    case Between::ease:
      moment.t = t * t * (3 - 2 * t);
      break;
    case Between::step:
      break;
  }
  return moment;
}

}  // namespace krok
