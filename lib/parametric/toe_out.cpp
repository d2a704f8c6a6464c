#include <algorithm>
#include <cmath>

#include "math/types.h"
#include "motion/ground_frame.h"
#include "parametric/footprint.h"

namespace krok::parametric {

namespace {

constexpr double kShortestWay = 0.2;  // metres, of two steps
constexpr std::size_t kFewestPrints = 3;

}  // namespace

std::array<double, 2> toe_out_of(std::span<const std::vector<WalkPrint>> walks) {
  std::array<std::vector<double>, 2> angles;
  for (const auto& prints : walks) {
    for (std::size_t i = 1; i + 1 < prints.size(); ++i) {
      const WalkPrint &before = prints[i - 1], &here = prints[i], &after = prints[i + 1];
      if (before.side == here.side || after.side == here.side) continue;
      const Vec3 way = after.print.place - before.print.place;
      if (std::hypot(way.x(), way.z()) < kShortestWay) continue;
      const double angle = wrapped(here.print.heading - std::atan2(way.x(), way.z()));
      // Not of steps to the side or backwards.
      if (std::abs(angle) > kPi / 3) continue;
      angles[static_cast<std::size_t>(here.side)].push_back(angle);
    }
  }
  std::array<double, 2> result{};
  for (std::size_t s = 0; s < 2; ++s) {
    if (angles[s].size() < kFewestPrints) return {};
    const auto middle = angles[s].begin() + static_cast<std::ptrdiff_t>(angles[s].size() / 2);
    std::ranges::nth_element(angles[s], middle);
    result[s] = *middle;
  }
  return result;
}

}  // namespace krok::parametric
