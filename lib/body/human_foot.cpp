#include <algorithm>
#include <cmath>

#include "body/human_parts.h"

// The feet of the human shape.

namespace krok::body {

void HumanBuilder::build_foot(std::size_t side) {
  const double u = unit_;
  const auto& leg = actor_.legs[side];
  const Vec3 ankle = position(leg.ankle);
  const int far = leg.toes >= 0 ? leg.toes : leg.tip;
  // Forward along the foot, horizontal; towards the ball of the foot if the skeleton has it.
  Vec3 forward = Vec3::UnitZ();
  double ball = 0.078 * u;
  if (far >= 0) {
    Vec3 level = position(far) - ankle;
    level.y() = 0;
    if (level.norm() > 0.03 * u && level.z() > 0) {
      forward = level.normalized();
      if (leg.toes >= 0) ball = std::clamp(level.norm(), 0.06 * u, 0.11 * u);
    }
  }
  // The sole is a malleolus height (0.039 of stature) below the ankle, or at the toes.
  double sole = ankle.y() - 0.039 * u;
  if (leg.toes >= 0) {
    sole = std::clamp(position(leg.toes).y() - 0.010 * u, ankle.y() - 0.065 * u,
                      ankle.y() - 0.036 * u);
  }
  const double high = (ankle.y() - sole) / 0.039;
  const double stretch = ball / (0.078 * u);
  const Vec3 across = Vec3::UnitY().cross(forward);  // left
  const double out = side == 0 ? 1.0 : -1.0;
  struct Row {
    double forward, height, width, thick, outward;
  };
  constexpr Row kRows[] = {
      {-0.026, 0.0190, 0.0175, 0.0215, 0.0000}, {0.000, 0.0220, 0.0190, 0.0270, 0.0000},
      {0.030, 0.0200, 0.0210, 0.0240, 0.0010},  {0.058, 0.0150, 0.0245, 0.0185, 0.0020},
      {0.080, 0.0110, 0.0275, 0.0140, 0.0015},  {0.100, 0.0085, 0.0250, 0.0110, 0.0005},
      {0.112, 0.0070, 0.0190, 0.0085, -0.0010}};
  Tube tube;
  for (const Row& row : kRows) {
    Station station;
    const double ahead = row.forward > 0 ? row.forward * stretch : row.forward;
    station.center = ankle + forward * (ahead * u) + across * (row.outward * out * u);
    const double lift = row.forward < 0.05 ? high / u : 1.0;
    station.center.y() = sole + row.height * u * std::min(lift, 1.3);
    station.width = row.width * u;
    station.depth = row.thick * u * std::min(lift, 1.3);
    station.cap = std::min(0.016, row.width) * u;
    station.side = across;
    station.front = Vec3::UnitY();
    station.arc = ahead * u;
    station.along = along_[static_cast<std::size_t>(leg.ankle)] + std::max(0.0, ahead * u);
    station.detail = 0.7;
    tube.stations.push_back(station);
  }
  tube.cuts = {{-Vec3::UnitY(), -sole, 0.006 * u}};
  tube.joints = {{leg.ankle, -1e9, 0}};
  if (leg.toes >= 0) tube.joints.push_back({leg.toes, ball, 0.020 * u});
  if (leg.sole >= 0) tube.joints.push_back({leg.sole, 0.0, 0.020 * u});
  feet_[side] = shape_.add(std::move(tube));
}

}  // namespace krok::body
