#include "body/human_hand.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "body/turn_joint.h"
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

}  // namespace krok::body
