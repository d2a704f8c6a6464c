#include <algorithm>
#include <cmath>

#include "body/human_parts.h"

// The hands of the human shape.

namespace krok::body {

void HumanBuilder::build_hand(std::size_t side) {
  const double u = unit_;
  const auto& arm = actor_.arms[side];
  const HandLayout hand = hand_layout(skeleton_, actor_, side, pose_);
  const Vec3 wrist = position(arm.wrist), thick = hand.along.cross(hand.across);
  struct Row {
    double ahead, width, thick;
  };
  constexpr Row kRows[] = {{-0.016, 0.0120, 0.0090},
                           {0.010, 0.0175, 0.0115},
                           {0.030, 0.0225, 0.0115},
                           {0.046, 0.0235, 0.0100},
                           {0.055, 0.0215, 0.0080}};
  Tube palm;
  for (const Row& row : kRows) {
    Station station;
    station.center = wrist + hand.along * (row.ahead * u);
    station.width = row.width * u;
    station.depth = row.thick * u;
    station.side = hand.across;
    station.front = thick;
    station.cap = 0.006 * u;
    station.arc = row.ahead * u;
    station.along = along_[static_cast<std::size_t>(arm.wrist)] + std::max(0.0, row.ahead * u);
    station.detail = 0.5;
    palm.stations.push_back(station);
  }
  palm.joints = {{arm.wrist, -1e9, 0}};
  palms_[side] = shape_.add(std::move(palm));

  // The skeleton's fingers, or a default hand that follows the available joints.
  if (hand.whole()) {
    if (!hand.thumb.empty()) build_finger_along(side, hand, hand.thumb);
    for (const auto& chain : hand.fingers) build_finger_along(side, hand, chain);
    if (!hand.thumb.empty()) return;
  }
  for (int finger = 0; finger < (hand.whole() ? 1 : 5); ++finger) {
    build_free_finger(side, hand, finger);
  }
}

void HumanBuilder::build_finger_along(std::size_t side, const HandLayout& hand,
                                      const std::vector<int>& chain) {
  const double u = unit_;
  const int wrist_joint = actor_.arms[side].wrist;
  const Vec3 wrist = position(wrist_joint), thick = hand.along.cross(hand.across);
  const double radius = 0.0047 * u;
  Tube tube;
  std::vector<Vec3> points;
  // Starts inside the palm, so that short and long chains connect to it.
  const Vec3 first = position(chain.front());
  points.push_back(wrist + 0.55 * (first - wrist));
  double arc = -(first - points.back()).norm();
  std::vector<double> arcs{arc};
  arc = 0;
  tube.joints = {{wrist_joint, -1e9, 0}};
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Vec3 at = position(chain[i]);
    if (i > 0) arc += (at - position(chain[i - 1])).norm();
    if (!skeleton_.end_sites[static_cast<std::size_t>(chain[i])]) {
      tube.joints.push_back({chain[i], arc, 0.006 * u});
    }
    if ((at - points.back()).norm() < 0.004 * u) continue;
    points.push_back(at);
    arcs.push_back(arc);
  }
  if (!skeleton_.end_sites[static_cast<std::size_t>(chain.back())] && points.size() > 1) {
    const Vec3 last = points[points.size() - 1] - points[points.size() - 2];
    points.push_back(points.back() + last.normalized() * (0.013 * u));
    arcs.push_back(arc + 0.013 * u);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 next = points[std::min(i + 1, points.size() - 1)];
    const Vec3 previous = points[i > 0 ? i - 1 : 0];
    const Vec3 direction = (next - previous).normalized();
    Station station;
    station.center = points[i];
    const double taper =
        1.12 - 0.3 * static_cast<double>(i) / static_cast<double>(points.size() - 1);
    station.width = station.depth = station.cap = radius * taper;
    station.front = thick;
    station.side = direction.cross(thick);
    station.arc = arcs[i];
    station.along = along_[static_cast<std::size_t>(chain.front())] + std::max(0.0, arcs[i]);
    station.detail = 0.32;
    tube.stations.push_back(station);
  }
  fingers_[side].push_back(shape_.add(std::move(tube)));
}

void HumanBuilder::build_free_finger(std::size_t side, const HandLayout& hand, int finger) {
  const double u = unit_;
  const int wrist_joint = actor_.arms[side].wrist;
  const Vec3 wrist = position(wrist_joint), thick = hand.along.cross(hand.across);
  std::vector<int> chain = hand.thumb;
  if (finger > 0) chain = hand.fingers.empty() ? std::vector<int>() : hand.fingers.front();
  // Thumb, then index to little finger: start, length, spread.
  struct Row {
    double ahead, aside, length, radius, spread;
  };
  constexpr Row kRows[] = {{0.014, 0.0150, 0.050, 0.0064, 0.75},
                           {0.044, 0.0172, 0.050, 0.0046, 0.20},
                           {0.047, 0.0060, 0.055, 0.0048, 0.065},
                           {0.046, -0.0058, 0.052, 0.0046, -0.075},
                           {0.042, -0.0170, 0.042, 0.0042, -0.21}};
  const Row& row = kRows[finger];
  const Vec3 palm_side = thick * (thick.y() > 0 ? -1.0 : 1.0);
  const Vec3 start = wrist + (hand.along * row.ahead + hand.across * row.aside) * u;
  const Vec3 direction = (hand.along + hand.across * row.spread).normalized();
  Tube tube;
  for (int i = 0; i <= 3; ++i) {
    const double t = i / 3.0;
    Station station;
    // Slightly bent, as in a relaxed hand.
    station.center = start + (direction * t + palm_side * (0.16 * t * t)) * (row.length * u);
    station.width = station.depth = station.cap = row.radius * (1.05 - 0.22 * t) * u;
    station.front = thick;
    station.side = direction.cross(thick);
    station.arc = (station.center - wrist).dot(hand.along);
    station.along = along_[static_cast<std::size_t>(wrist_joint)] + station.arc;
    station.detail = 0.32;
    tube.stations.push_back(station);
  }
  tube.joints = {{wrist_joint, -1e9, 0}};
  for (const int joint : chain) {
    if (skeleton_.end_sites[static_cast<std::size_t>(joint)]) continue;
    const double at = (position(joint) - wrist).dot(hand.along);
    tube.joints.push_back({joint, std::max(at, tube.joints.back().at), 0.010 * u});
  }
  fingers_[side].push_back(shape_.add(std::move(tube)));
}

}  // namespace krok::body
