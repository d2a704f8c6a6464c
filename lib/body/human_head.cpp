#include <algorithm>

#include "body/human_parts.h"

namespace krok::body {

// Neck, head and face of the human shape.

int HumanBuilder::chest_joint() const {
  const auto path = joint_path(skeleton_, 0, actor_.arms[0].shoulder);
  const auto other = joint_path(skeleton_, 0, actor_.arms[1].shoulder);
  int common = path.front();
  for (std::size_t i = 0; i < std::min(path.size(), other.size()) && path[i] == other[i]; ++i) {
    common = path[i];
  }
  return common;
}

// The top of the head: the end site if plausible, else derived from the joint at the skull's base.
void HumanBuilder::place_head() {
  const double u = unit_;
  head_ = actor_.head >= 0 ? actor_.head : actor_.neck;
  const Vec3 joint = position(head_);
  double top = joint.y() + 0.118 * u;
  if (actor_.head_top >= 0) {
    const double above = position(actor_.head_top).y() - joint.y();
    if (above > 0.085 * u && above < 0.16 * u) top = joint.y() + above;
  }
  // Keeps a plausible distance from the shoulders.
  const double shoulder = trunk_point(0.285, 0, 0).y();
  top = std::clamp(top, shoulder + 0.165 * u, shoulder + 0.205 * u);
  crown_ = Vec3(joint.x(), top, joint.z() + 0.010 * u);
}

Vec3 HumanBuilder::head_point(double left, double below_top, double forward) const {
  return crown_ + Vec3(left, -below_top, forward) * unit_;
}

void HumanBuilder::build_neck() {
  const double u = unit_;
  const Vec3 base = trunk_point(0.285, 0, -0.012);
  const Vec3 skull_base = head_point(0, 0.100, -0.012);
  Tube neck;
  const auto add = [&](const Vec3& center, double width, double depth) {
    Station station;
    station.center = center;
    station.width = width * u;
    station.depth = depth * u;
    station.arc = center.y() - base.y();
    station.along = along_[static_cast<std::size_t>(head_)];
    station.detail = 0.9;
    neck.stations.push_back(station);
  };
  add(base, 0.0400, 0.0380);
  add(base + 0.35 * (skull_base - base), 0.0350, 0.0355);
  add(base + 0.65 * (skull_base - base), 0.0325, 0.0345);
  add(skull_base, 0.0325, 0.0360);
  neck.joints =
      joints_along(joint_path(skeleton_, chest_joint(), head_), base, Vec3::UnitY(), 0.022 * u);
  neck_ = shape_.add(std::move(neck));
}

// A tube that moves with the head: rows of a point and half-axes, as fractions of stature.
int HumanBuilder::add_head_tube(std::initializer_list<HeadRow> rows, double detail) {
  Tube tube;
  for (const HeadRow& row : rows) {
    Station station;
    station.center = head_point(row.left, row.below_top, row.forward);
    station.width = row.width * unit_;
    station.depth = row.depth * unit_;
    station.cap = row.cap * unit_;
    station.along = along_[static_cast<std::size_t>(head_)] +
                    std::max(0.0, station.center.y() - position(head_).y());
    station.detail = detail;
    tube.stations.push_back(station);
  }
  tube.joints = {{head_, 0, 0}};
  return shape_.add(std::move(tube));
}

void HumanBuilder::build_head() {
  skull_ = add_head_tube({{0, 0.0510, -0.002, 0.0425, 0.0550, 0.0510}}, 0.75);
  face_ = add_head_tube({{0, 0.050, 0.017, 0.036, 0.033, 0.030},
                         {0, 0.080, 0.023, 0.033, 0.030, 0.030},
                         {0, 0.103, 0.027, 0.026, 0.0245, 0.020},
                         {0, 0.116, 0.034, 0.016, 0.0160, 0.0135}},
                        0.60);
  for (std::size_t side = 0; side < 2; ++side) {
    const double out = side == 0 ? 1.0 : -1.0;
    ears_[side] = add_head_tube({{0.0425 * out, 0.070, -0.004, 0.0055, 0.0105, 0.0165}}, 0.40);
  }
  build_face();
}

// A simple face. The eye sockets result from brow, nose and cheek-bones; nothing is cut out.
void HumanBuilder::build_face() {
  const double fine = 0.42;
  const int nose = add_head_tube({{0, 0.058, 0.0510, 0.0050, 0.0060, 0.005},
                                  {0, 0.069, 0.0540, 0.0055, 0.0060, 0.005},
                                  {0, 0.079, 0.0575, 0.0080, 0.0068, 0.006}},
                                 0.40);
  const int upper_lip = add_head_tube({{0, 0.0920, 0.0505, 0.0110, 0.0050, 0.0040}}, fine);
  const int lower_lip = add_head_tube({{0, 0.0995, 0.0495, 0.0095, 0.0052, 0.0045}}, fine);
  const int chin = add_head_tube({{0, 0.1140, 0.0445, 0.0100, 0.0080, 0.0080}}, 0.5);
  features_ = {nose, upper_lip, lower_lip, chin};
  for (const double out : {1.0, -1.0}) {
    const int brow = add_head_tube({{0.006 * out, 0.0550, 0.0520, 0.0050, 0.0050, 0.0045},
                                    {0.017 * out, 0.0530, 0.0495, 0.0050, 0.0050, 0.0045},
                                    {0.027 * out, 0.0565, 0.0415, 0.0050, 0.0050, 0.0045}},
                                   fine);
    const int cheek = add_head_tube({{0.0220 * out, 0.0785, 0.0345, 0.0130, 0.0110, 0.0100}}, 0.5);
    features_.insert(features_.end(), {brow, cheek});
    shape_.blends.push_back({{nose, brow}, 0.008 * unit_});
  }
}

// The feet of the human shape.

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
