#include <algorithm>
#include <cmath>

#include "body/human_parts.h"

// Neck, head and feet of the human shape.

namespace krok::body {

int HumanBuilder::chest_joint() const {
  const auto path = joint_path(skeleton_, 0, figure_.arms[0].shoulder);
  const auto other = joint_path(skeleton_, 0, figure_.arms[1].shoulder);
  int common = path.front();
  for (std::size_t i = 0; i < std::min(path.size(), other.size()) && path[i] == other[i]; ++i) {
    common = path[i];
  }
  return common;
}

void HumanBuilder::build_neck_and_head() {
  const double u = unit_;
  const int head = figure_.head >= 0 ? figure_.head : figure_.neck;
  const Vec3 joint = position(head);
  // The top of the head: the end site where it is plausible, else from the joint at the skull's
  // base.
  double top = joint.y() + 0.118 * u;
  if (figure_.head_top >= 0) {
    const double above = position(figure_.head_top).y() - joint.y();
    if (above > 0.085 * u && above < 0.16 * u) top = joint.y() + above;
  }
  // Not sunk into the shoulders, not on a stalk.
  const double shoulder = trunk_point(0.285, 0, 0).y();
  top = std::clamp(top, shoulder + 0.165 * u, shoulder + 0.205 * u);
  const Vec3 middle(joint.x(), top, joint.z() + 0.010 * u);
  const auto at = [&](double left, double below_top, double forward) -> Vec3 {
    return middle + Vec3(left, -below_top, forward) * u;
  };

  const auto path = joint_path(skeleton_, chest_joint(), head);
  const Vec3 base = trunk_point(0.285, 0, -0.012);
  const Vec3 skull_base = at(0, 0.100, -0.012);
  Tube neck;
  const auto add = [&](const Vec3& center, double width, double depth) {
    Station station;
    station.center = center;
    station.width = width * u;
    station.depth = depth * u;
    station.arc = center.y() - base.y();
    station.along = along_[static_cast<std::size_t>(head)];
    station.detail = 0.9;
    neck.stations.push_back(station);
  };
  add(base, 0.0400, 0.0380);
  add(base + 0.35 * (skull_base - base), 0.0350, 0.0355);
  add(base + 0.65 * (skull_base - base), 0.0325, 0.0345);
  add(skull_base, 0.0325, 0.0360);
  neck.joints = joints_along(path, base, Vec3::UnitY(), 0.022 * u);
  neck_ = shape_.add(std::move(neck));

  const TubeJoint owner{head, 0, 0};
  const auto head_station = [&](const Vec3& center, double width, double depth, double cap,
                                double detail) {
    Station station;
    station.center = center;
    station.width = width * u;
    station.depth = depth * u;
    station.cap = cap * u;
    station.along = along_[static_cast<std::size_t>(head)] + std::max(0.0, center.y() - joint.y());
    station.detail = detail;
    return station;
  };
  const auto add_head_tube = [&](std::vector<Station> stations) {
    Tube tube;
    tube.stations = std::move(stations);
    tube.joints = {owner};
    return shape_.add(std::move(tube));
  };
  skull_ = add_head_tube({head_station(at(0, 0.0510, 0.000), 0.0425, 0.0550, 0.0510, 0.75)});
  face_ = add_head_tube({head_station(at(0, 0.050, 0.018), 0.036, 0.034, 0.03, 0.65),
                         head_station(at(0, 0.080, 0.024), 0.033, 0.030, 0.03, 0.60),
                         head_station(at(0, 0.103, 0.028), 0.026, 0.0245, 0.02, 0.60),
                         head_station(at(0, 0.116, 0.035), 0.016, 0.0160, 0.0135, 0.60)});
  nose_ = add_head_tube({head_station(at(0, 0.062, 0.0500), 0.0055, 0.0060, 0.005, 0.40),
                         head_station(at(0, 0.079, 0.0575), 0.0085, 0.0070, 0.006, 0.40)});
  for (std::size_t side = 0; side < 2; ++side) {
    const double out = side == 0 ? 1.0 : -1.0;
    ears_[side] = add_head_tube(
        {head_station(at(0.0425 * out, 0.070, -0.002), 0.0055, 0.0105, 0.0165, 0.40)});
  }
}

void HumanBuilder::build_foot(std::size_t side) {
  const double u = unit_;
  const auto& leg = figure_.legs[side];
  const Vec3 ankle = position(leg.ankle);
  const int far = leg.toes >= 0 ? leg.toes : leg.tip;
  // Forward along the foot, level; the ball of the foot where the skeleton has it.
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
  // The sole lies a malleolus' height (0.039 of the stature) below the ankle, or where the toes
  // are.
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
  feet_[side] = shape_.add(std::move(tube));
}

}  // namespace krok::body
