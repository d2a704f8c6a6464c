#include "gait/sole_place_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace krok::gait {

namespace {

constexpr double kSoleSample = 0.01;   // metres along the sole
constexpr double kSoleEdge = 0.025;    // metres from sample to sample: steeper than can be stood on
constexpr double kSoleMargin = 0.005;  // metres between heel or ball and an edge
constexpr double kSteepAcross = 0.9;   // height by width, the tangent of 42 degrees
constexpr double kOverhead = 0.4;      // metres: what is higher is another storey

}  // namespace

SoleGround ground_under_sole(const Print& print, double near, const Terrain& ground,
                             const PlanOptions& options) {
  const Vec2 ahead(std::sin(print.heading), std::cos(print.heading));
  const Vec2 left(ahead.y(), -ahead.x());
  const auto at_heel = ground.at(print.x, print.z, near + kOverhead);
  if (!at_heel) return {};
  SoleGround result{SolePlace::whole, at_heel->height};
  const double half = 0.5 * options.sole_width;
  std::array<double, 3> last = {at_heel->height, at_heel->height, at_heel->height};
  bool first = true;
  const double end = options.heel_to_toes;
  const int samples = static_cast<int>(std::ceil((end + kSoleMargin) / kSoleSample));
  for (int i = 0; i <= samples; ++i) {
    const double along = std::min(i * kSoleSample - kSoleMargin, end);
    std::array<double, 3> heights{};
    double edge = 0;  // 0: none, otherwise up or down
    for (std::size_t line = 0; line < 3; ++line) {
      // Toes are round: half as wide at the tip.
      const double narrow = along > options.heel_to_ball ? 0.5 : 1;
      const double across = (static_cast<double>(line) - 1) * half * narrow;
      const double x = print.x + along * ahead.x() + across * left.x();
      const double z = print.z + along * ahead.y() + across * left.y();
      const auto found = ground.at(x, z, last[line] + kOverhead);
      if (!found) {
        if (edge == 0) edge = -1;
        continue;
      }
      heights[line] = found->height;
      const double change = found->height - last[line];
      if (!first && std::abs(change) > kSoleEdge && edge <= 0) edge = change;
    }
    if (edge == 0 && std::abs(heights[2] - heights[0]) > kSteepAcross * options.sole_width) {
      edge = 1;
    }
    if (edge != 0) {
      const bool toes = along > options.heel_to_ball + kSoleMargin;
      result.place = toes && edge < 0 ? SolePlace::heel_and_ball : SolePlace::none;
      return result;
    }
    last = heights;
    first = false;
  }
  return result;
}

}  // namespace krok::gait
