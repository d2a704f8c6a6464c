#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "formats/bvh/angle_unit_internal.h"
#include "math/types.h"

namespace krok::bvh {

std::optional<std::string> looks_like_radians(const Hierarchy& hierarchy, const SampleRows& rows) {
  // A moving character rotates some joint by more than 0.5 rad, and many by more than 0.1 rad.
  constexpr double kMoves = 0.5;
  constexpr double kTurns = 0.1;
  constexpr int kFewestChannels = 6;
  constexpr double kWholeTurn = 2.0 * kPi * 1.001;
  double largest = 0;
  int turning = 0;
  for (std::size_t c = 0; c < hierarchy.channels.size(); ++c) {
    if (hierarchy.channels[c].kind != ChannelKind::rotation) continue;
    double most = 0;
    for (std::size_t row = 0; row < rows.count(); ++row) {
      most = std::max(most, std::abs(rows.row(row)[c]));
    }
    if (most > kWholeTurn) return std::nullopt;
    largest = std::max(largest, most);
    if (most > kTurns) ++turning;
  }
  if (largest < kMoves || turning < kFewestChannels) return std::nullopt;
  return fmt::format("no rotation exceeds {}, which is less than a full turn in radians",
                     readable(largest, 3));
}

}  // namespace krok::bvh
