#include "body/human_parts.h"

#include <algorithm>
#include <string>

#include "body/human_actor.h"
#include "math/quaternion.h"

namespace krok::body {

namespace {

// From the wrist, over stature. A chain without length at the wrist, such as a prop's joint, is no
// finger.
constexpr double kShortestFinger = 0.02;

bool named_thumb(const std::string& name) {
  std::string lower = name;
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower.find("thumb") != std::string::npos;
}

}  // namespace

HandLayout hand_layout(const Skeleton& skeleton, const HumanActor& actor, std::size_t side,
                       std::span<const Transform> pose) {
  const auto at = [&pose](int joint) { return pose[static_cast<std::size_t>(joint)].position; };
  const double u = actor.stature;
  const auto& arm = actor.arms[side];
  const Vec3 wrist = at(arm.wrist);
  HandLayout hand;
  const Vec3 forearm = (wrist - at(arm.elbow)).normalized();

  for (std::vector<int> chain : arm.fingers) {
    // Joints between wrist and knuckle, and those that go against the finger's direction, are
    // part of the palm. A thumb starts near the wrist, and its first bone may point sideways.
    const bool thumb = named_thumb(skeleton.names[static_cast<std::size_t>(chain.back())]);
    while (chain.size() > 2) {
      const Vec3 first = at(chain[1]) - at(chain[0]), whole = at(chain.back()) - at(chain[0]);
      const bool palm = !thumb && (at(chain[0]) - wrist).norm() < 0.030 * u;
      const bool aside = turn_angle(first, whole) > (thumb ? 80 : 50) * kRadiansPerDegree;
      const bool short_bone = first.norm() < 1e-3 * u;
      if (!palm && !aside && !short_bone) break;
      chain.erase(chain.begin());
    }
    const bool within_wrist = std::ranges::all_of(
        chain, [&](int joint) { return (at(joint) - wrist).norm() < kShortestFinger * u; });
    if (chain.size() < 2 || within_wrist) continue;
    if (hand.thumb.empty() && thumb) {
      hand.thumb = std::move(chain);
    } else {
      hand.fingers.push_back(std::move(chain));
    }
  }
  if (hand.thumb.empty() && hand.fingers.size() >= 5) {  // by where it points
    auto widest = hand.fingers.begin();
    const auto aside = [&](const std::vector<int>& chain) {
      return turn_angle(at(chain.back()) - wrist, forearm);
    };
    for (auto it = hand.fingers.begin(); it != hand.fingers.end(); ++it) {
      if (aside(*it) > aside(*widest)) widest = it;
    }
    hand.thumb = std::move(*widest);
    hand.fingers.erase(widest);
  }
  Vec3 knuckles = Vec3::Zero();
  for (const auto& chain : hand.fingers) {
    const Vec3 offset = at(chain.front()) - wrist;
    if (offset.norm() > 0.01 * u) knuckles += offset.normalized();
  }
  hand.along = knuckles.norm() > 0.5 ? Vec3(knuckles.normalized()) : forearm;
  if (hand.along.dot(forearm) < 0.5) hand.along = forearm;

  const auto sideways = [&hand](const Vec3& v) -> Vec3 {
    return v - hand.along * hand.along.dot(v);
  };
  Vec3 thumb = Vec3::UnitZ();  // forward if there is no thumb
  if (!hand.thumb.empty() && sideways(at(hand.thumb.back()) - wrist).norm() > 0.012 * u) {
    thumb = at(hand.thumb.back()) - wrist;
  }
  Vec3 across = sideways(thumb);
  if (hand.whole()) {
    Vec3 widest = Vec3::Zero();
    for (const auto& a : hand.fingers) {
      for (const auto& b : hand.fingers) {
        const Vec3 between = sideways(at(a.front()) - at(b.front()));
        if (between.norm() > widest.norm() * (1 + 1e-9)) widest = between;
      }
    }
    if (widest.norm() > 0.012 * u) across = widest.dot(thumb) < 0 ? Vec3(-widest) : widest;
  }
  if (across.norm() < 1e-3 * std::max(u, thumb.norm())) across = sideways(Vec3::UnitX());
  if (across.norm() < 1e-9) across = hand.along.unitOrthogonal();
  hand.across = across.normalized();
  std::stable_sort(hand.fingers.begin(), hand.fingers.end(), [&](const auto& a, const auto& b) {
    return at(a.front()).dot(hand.across) > at(b.front()).dot(hand.across);
  });
  return hand;
}

std::vector<Transform> spread_fingers(const Skeleton& skeleton, const HumanActor& actor,
                                      std::span<const Transform> pose) {
  std::vector<Transform> spread(pose.begin(), pose.end());
  for (std::size_t side = 0; side < 2; ++side) {
    const HandLayout hand = hand_layout(skeleton, actor, side, spread);
    if (!hand.whole()) continue;
    const auto turn = [&](int joint, int child, const Vec3& wanted) {
      const Vec3 now = spread[static_cast<std::size_t>(child)].position -
                       spread[static_cast<std::size_t>(joint)].position;
      if (now.norm() < 1e-4 * actor.stature) return;
      turn_joint(skeleton, joint, shortest_arc(now, wanted), spread);
    };
    const auto count = static_cast<double>(hand.fingers.size());
    for (std::size_t i = 0; i < hand.fingers.size(); ++i) {
      const auto& chain = hand.fingers[i];
      const double aside = 0.34 * (1 - 2 * static_cast<double>(i) / (count - 1));
      const Vec3 direction = hand.along + aside * hand.across;
      for (std::size_t k = 0; k + 1 < chain.size(); ++k) turn(chain[k], chain[k + 1], direction);
    }
    if (hand.thumb.size() >= 2) {
      const Vec3 direction = hand.along + 0.9 * hand.across;
      for (std::size_t k = 0; k + 1 < hand.thumb.size(); ++k) {
        turn(hand.thumb[k], hand.thumb[k + 1], direction);
      }
    }
  }
  return spread;
}

// The hands of the human shape.

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
