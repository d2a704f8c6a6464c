#include "motion/displacement.h"

#include <cassert>

namespace krok {

Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints) {
  return largest_displacement(before, after, joints, 0, before.frame_count());
}

Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints, int begin, int end) {
  assert(before.positions.size() == after.positions.size());
  Displacement largest;
  for (int f = begin; f < end; ++f) {
    const auto from = before.frame_positions(f), to = after.frame_positions(f);
    for (const int j : joints) {
      const auto at = static_cast<std::size_t>(j);
      const double distance = (to[at].cast<double>() - from[at].cast<double>()).norm();
      if (distance > largest.distance) largest = {distance, j, f};
    }
  }
  return largest;
}

}  // namespace krok
