#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "plant/plant_feet.h"
#include "support/foot_skate.h"

// What a clean-up of foot skate achieves, and what it costs.

namespace krok::test {

// Of one clip.
struct Measures {
  double drift = 0;                  // metres, largest
  double knee_99 = 1, knee_max = 1;  // of the input's
  double height = 0;                 // metres, largest
  int stays = 0, high = 0;           // heels and balls; those whose height is off by over 1 mm
  double stretch = 0;                // metres, largest
};

inline Vec3 place_of(const Clip& clip, int frame, const SolePoint& point) {
  return joint_of(clip, frame, point.joint) * point.offset;
}

inline double median_height(const Clip& clip, const FixedStay& stay) {
  std::vector<double> heights;
  for (int f = stay.first; f <= stay.last; ++f) {
    heights.push_back(place_of(clip, f, stay.point).y());
  }
  std::ranges::sort(heights);
  return 0.5 * (heights[heights.size() / 2] + heights[(heights.size() - 1) / 2]);
}

// The largest distance of the same joints, `offset` joints on in b.
inline double apart(const Clip& a, const Clip& b, int offset = 0) {
  double most = 0;
  for (int f = 0; f < a.frame_count(); ++f) {
    for (int j = 0; j < a.joint_count(); ++j) {
      most = std::max<double>(most, (a.frame_positions(f)[static_cast<std::size_t>(j)] -
                                     b.frame_positions(f)[static_cast<std::size_t>(j + offset)])
                                        .norm());
    }
  }
  return most;
}

// `clean` has the heights at which points should stand.
inline Measures measure(const Clip& input, const Clip& clean, const RoleMap& roles,
                        const std::vector<FixedStay>& stays, const Clip& result) {
  Measures measures;
  for (const FixedStay& stay : stays) {
    if (stay.point.part == FootPart::tip) continue;
    const double height = median_height(clean, stay);
    Vec3 low = place_of(result, stay.first, stay.point), high = low;
    double off = 0;
    for (int f = stay.first; f <= stay.last; ++f) {
      const Vec3 place = place_of(result, f, stay.point);
      low = low.cwiseMin(place);
      high = high.cwiseMax(place);
      off = std::max(off, std::abs(place.y() - height));
    }
    measures.drift = std::max(measures.drift, (high - low).norm());
    measures.height = std::max(measures.height, off);
    measures.stays += 1;
    measures.high += off > 0.001 ? 1 : 0;
  }
  // Captures may begin with a rest pose.
  const auto before = knee_acceleration(input, roles, 1);
  const auto after = knee_acceleration(result, roles, 1);
  if (before.max > 0) {
    measures.knee_99 = after.percentile_99 / before.percentile_99;
    measures.knee_max = after.max / before.max;
  }
  for (int f = 0; f < result.frame_count(); ++f) {
    for (int j = 1; j < result.joint_count(); ++j) {
      const int parent = result.skeleton.parents[static_cast<std::size_t>(j)];
      const auto length = [&](const Clip& clip) {
        return (joint_of(clip, f, j).position - joint_of(clip, f, parent).position).norm();
      };
      if (parent == 0) continue;  // a root may be apart from the hips
      measures.stretch = std::max(measures.stretch, std::abs(length(result) - length(input)));
    }
  }
  return measures;
}

}  // namespace krok::test
