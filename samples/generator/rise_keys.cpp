#include "samples/generator/rise_keys.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace krok::samples {

namespace {

// Both limbs alike, given for the left.
std::array<LimbKey, 2> both(const LimbKey& left) {
  LimbKey right = left;
  right.place.x() *= -1;
  right.pole.x() *= -1;
  return {left, right};
}

// Hips, thighs and shanks of 1.75 m.
constexpr double kHipBelow = 0.026, kThighLength = 0.429, kShankLength = 0.4305;
constexpr double kKneeHeight175 = 0.076, kAnkleLies = 0.09;  // on the ground
constexpr double kKneeAt = -0.36;                            // of the kneeling, along z

// The left leg with its knee on the ground below or behind the pelvis, and its shank along it.
LimbKey on_knees(const Vec3& pelvis, double pitch, double pointed) {
  const double angle = pitch * kRadiansPerDegree;
  const double height = pelvis.y() - kHipBelow * std::cos(angle) - kKneeHeight175;
  const double hip = pelvis.z() - kHipBelow * std::sin(angle);
  const double knee = hip - std::sqrt(std::max(0.0, kThighLength * kThighLength - height * height));
  const double rise = kAnkleLies - kKneeHeight175;
  const double ankle = knee - std::sqrt(kShankLength * kShankLength - rise * rise);
  return {{0.1, kAnkleLies, ankle}, {0.08, -1, 0.35}, 1, pointed};
}

// The pelvis above the kneeling knee, its thigh leaning forwards by `lean` degrees.
Vec3 above_knee(double x, double lean, double pitch) {
  const double thigh = lean * kRadiansPerDegree, angle = pitch * kRadiansPerDegree;
  return {x, kKneeHeight175 + kThighLength * std::cos(thigh) + kHipBelow * std::cos(angle),
          kKneeAt + kThighLength * std::sin(thigh) + kHipBelow * std::sin(angle)};
}

RiseKey on_all_fours(double time, const Vec3& pelvis, double pitch, double spine, double head) {
  const LimbKey hand{{0.24, 0.033, 0.255}, {1, 0.2, -0.6}, 0, 0};
  return {time, pelvis, pitch, 0, spine, head, both(hand), both(on_knees(pelvis, pitch, 70))};
}

RiseKey standing(double time, double z) {
  const LimbKey hand{{0.28, 0.8, z}, {0.5, 0, -1}, 1, 0};
  RiseKey key{time, {0, 0.945, z}, 2, 0, 2, 0, both(hand), {}};
  key.feet = both({{0.0875, 0, z + 0.046}, {0.1, 0, 1}, 0, 0});
  return key;
}

// Shared by front and side: from hands and knees to standing; the right foot steps forwards.
std::vector<RiseKey> from_knees(double begin) {
  const LimbKey right_on_foot{{-0.1, 0, 0.181}, {-0.25, 0.7, 1}, 0, 0};
  const LimbKey left_on_toes{{0.1, 0.014, -0.838}, {0.1, -1, 0.8}, 0, 88};
  const auto hanging = [](double side, double x, double y, double z) {
    return LimbKey{{side * x, y, z}, {side * 0.7, 0, -1}, 1, 0};
  };
  const auto half_kneeling = [&](double time, const Vec3& pelvis, double pitch, double spine,
                                 double head, const LimbKey& right) {
    RiseKey key = on_all_fours(begin + time, pelvis, pitch, spine, head);
    key.feet = {left_on_toes, right};
    return key;
  };
  std::vector<RiseKey> keys;
  keys.push_back(on_all_fours(begin, above_knee(0, 0, 80), 80, 8, -25));
  keys.push_back(half_kneeling(0.3, above_knee(0.02, 0, 79), 79, 10, -25,
                               {{-0.14, 0.14, -0.67}, {-0.4, -0.8, 0.8}, 1, 50}));
  keys.push_back(half_kneeling(0.65, above_knee(0.03, 0, 77), 77, 14, -25,
                               {{-0.17, 0.2, -0.24}, {-0.6, 0, 1}, 1, 25}));
  keys.push_back(half_kneeling(1, above_knee(0.01, 4, 72), 72, 16, -25, right_on_foot));
  keys.push_back(half_kneeling(1.5, above_knee(-0.01, 12, 38), 38, 14, -12, right_on_foot));
  keys.back().hands = {hanging(1, 0.3, 0.38, 0.13),
                       LimbKey{{-0.14, 0.58, 0.15}, {-1, 0.1, -0.5}, 0.7, 0}};
  keys.push_back(half_kneeling(2, {-0.03, 0.66, -0.075}, 46, 14, -25, right_on_foot));
  keys.back().hands = {hanging(1, 0.27, 0.4, 0.25),
                       LimbKey{{-0.14, 0.6, 0.22}, {-1, 0.2, -0.6}, 0.8, 0}};
  keys.back().feet[0] = {{0.1, 0.016, -0.838}, {0.1, -0.3, 1}, 0, 76};
  keys.push_back({begin + 2.45, {-0.03, 0.8, 0.045}, 30, 0, 12, -20, {}, {}});
  keys.back().hands = {hanging(1, 0.27, 0.58, 0.25), hanging(-1, 0.22, 0.64, 0.27)};
  keys.back().feet = {LimbKey{{0.1, 0.07, -0.56}, {0.1, 0, 1}, 0, 70}, right_on_foot};
  keys.push_back({begin + 2.9, {-0.015, 0.915, 0.115}, 11, 0, 6, -8, {}, {}});
  keys.back().hands = {hanging(1, 0.28, 0.75, 0.19), hanging(-1, 0.28, 0.75, 0.19)};
  keys.back().feet = {LimbKey{{0.1, 0.08, 0}, {0.1, 0, 1}, 0, 22}, right_on_foot};
  keys.push_back(standing(begin + 3.25, 0.135));
  keys.push_back(standing(begin + 3.85, 0.135));
  keys[keys.size() - 2].feet[1] = keys.back().feet[1] = right_on_foot;
  return keys;
}

std::vector<RiseKey> front() {
  const auto lies = [](double time, const LimbKey& left_hand, double spine, double head) {
    const Vec3 pelvis(0, 0.118, 0);
    LimbKey leg = on_knees(pelvis, 90, 68);
    leg.pole = {1, -0.5, 0.2};
    return RiseKey{time, pelvis, 90, 0, spine, head, both(left_hand), both(leg)};
  };
  std::vector<RiseKey> keys = {lies(0, {{0.36, 0.045, 0.6}, {1, 0, -0.6}, 0, 0}, 0, -22),
                               lies(0.35, {{0.33, 0.06, 0.42}, {1, 0.5, -0.6}, 0, 0}, -2, -30),
                               lies(0.7, {{0.24, 0.033, 0.255}, {1, 0.5, -0.6}, 0, 0}, -4, -32),
                               on_all_fours(1.15, {0, 0.25, -0.04}, 74, -6, -30),
                               on_all_fours(1.45, {0, 0.4, -0.13}, 77, 0, -28)};
  for (const RiseKey& key : from_knees(1.8)) keys.push_back(key);
  return keys;
}

std::vector<RiseKey> back() {
  // The feet stay from the third key on.
  const auto feet = [](double pole_up) {
    return both({{0.1, 0, 0.5}, {0.15, pole_up, 1 - 0.7 * pole_up}, 0, 0});
  };
  const auto on_ground = [](double side, double x, double y, double z) {
    return LimbKey{{side * x, y, z}, {side * 0.9, 0.3, -0.7}, 0, 0};
  };
  const auto reaching = [](double side, double x, double y, double z) {
    return LimbKey{{side * x, y, z}, {side, -0.4, -0.4}, 1, 0};
  };
  const auto hands = [&](double x, double y, double z) {
    return std::array{on_ground(1, x, y, z), on_ground(-1, x, y, z)};
  };
  return {{0,
           {0, 0.12, 0},
           -90,
           0,
           0,
           4,
           hands(0.33, 0.04, 0.05),
           both({{0.1, 0.09, 0.86}, {0.2, 1, 0}, 1, 25})},
          {0.4,
           {0, 0.12, 0},
           -88,
           0,
           6,
           18,
           hands(0.33, 0.04, 0.02),
           both({{0.1, 0.1, 0.62}, {0.2, 1, 0}, 1, 10})},
          {0.75, {0, 0.125, 0}, -80, 0, 22, 28, hands(0.32, 0.036, -0.08), feet(1)},
          {1.3, {0, 0.136, 0}, -42, 0, 40, 16, hands(0.3, 0.036, -0.28), feet(1)},
          {1.7,
           {0.01, 0.135, 0.03},
           -8,
           0,
           44,
           0,
           {on_ground(1, 0.3, 0.036, -0.12), reaching(-1, 0.26, 0.4, 0.4)},
           feet(1)},
          {2.15,
           {0.01, 0.25, 0.17},
           32,
           0,
           40,
           -20,
           {on_ground(1, 0.3, 0.06, 0.02), reaching(-1, 0.2, 0.5, 0.72)},
           feet(1)},
          {2.55,
           {0, 0.42, 0.23},
           48,
           0,
           30,
           -35,
           {reaching(1, 0.24, 0.4, 0.62), reaching(-1, 0.22, 0.5, 0.74)},
           feet(0.8)},
          {3.0,
           {0, 0.68, 0.31},
           42,
           0,
           22,
           -30,
           {reaching(1, 0.24, 0.56, 0.7), reaching(-1, 0.24, 0.56, 0.7)},
           feet(0.4)},
          {3.5,
           {0, 0.885, 0.41},
           16,
           0,
           10,
           -10,
           both({{0.27, 0.72, 0.52}, {0.7, -0.1, -1}, 1, 0}),
           feet(0.2)},
          standing(3.9, 0.454),
          standing(4.4, 0.454)};
}

std::vector<RiseKey> side() {
  const auto foot = [](double x, double y, double z, const Vec3& knee, double pointed) {
    return LimbKey{{x, y, z}, knee, 1, pointed};
  };
  std::vector<RiseKey> keys = {
      {0,
       {0, 0.175, 0},
       80,
       -86,
       10,
       4,
       {LimbKey{{-0.42, 0.075, 0.62}, {-0.2, 0.1, -1}, 0.6, 0},
        LimbKey{{-0.34, 0.085, 0.36}, {0.1, 1, -0.4}, 0.3, 0}},
       {foot(-0.06, 0.075, -0.74, {-1, 0, 0.2}, 40), foot(-0.02, 0.2, -0.76, {-1, 0.1, 0.2}, 40)}},
      {0.45,
       {0.01, 0.19, 0},
       81,
       -70,
       10,
       -6,
       {LimbKey{{-0.3, 0.07, 0.56}, {0.2, 0.4, -1}, 0.4, 0},
        LimbKey{{-0.36, 0.06, 0.33}, {-0.4, 1, -0.4}, 0, 0}},
       {foot(-0.04, 0.085, -0.76, {-1, 0.05, 0.3}, 50),
        foot(-0.07, 0.17, -0.78, {-1, 0.05, 0.3}, 50)}},
      {0.95,
       {0, 0.21, -0.04},
       81,
       -34,
       4,
       -20,
       {LimbKey{{0.12, 0.07, 0.4}, {0.6, 1, -0.7}, 0, 0},
        LimbKey{{-0.28, 0.035, 0.255}, {-0.9, 0.6, -0.5}, 0, 0}},
       {foot(0.03, 0.1, -0.82, {-1, -0.05, 0.3}, 60),
        foot(-0.12, 0.12, -0.82, {-1, -0.2, 0.3}, 60)}},
      {1.25,
       {0, 0.29, -0.07},
       79,
       -18,
       0,
       -25,
       {LimbKey{{0.22, 0.045, 0.27}, {1, 0.7, -0.6}, 0, 0},
        LimbKey{{-0.24, 0.035, 0.255}, {-1, 0.5, -0.6}, 0, 0}},
       {foot(0.07, 0.1, -0.86, {-0.8, -0.5, 0.3}, 65),
        foot(-0.12, 0.1, -0.86, {-0.8, -0.5, 0.3}, 65)}},
      on_all_fours(1.6, {0, 0.42, -0.15}, 78, 0, -27)};
  for (const RiseKey& key : from_knees(1.95)) keys.push_back(key);
  return keys;
}

}  // namespace

std::span<const RiseKey> rise_keys(Lying from) {
  static const std::vector<RiseKey> kFront = front(), kBack = back(), kSide = side();
  return from == Lying::front ? kFront : from == Lying::back ? kBack : kSide;
}

}  // namespace krok::samples
