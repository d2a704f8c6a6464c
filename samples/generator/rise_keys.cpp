#include "samples/generator/rise_keys.h"

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

// Shared by front and side: from hands and knees to standing. The hands are at z = 0.3, the knees
// below the hips; the right foot steps forward.
const LimbKey kHandOnGround{{0.24, 0.03, 0.255}, {1, 0.2, -0.6}, 0, 0};
const LimbKey kKneeling{{0.1, 0.085, -0.765}, {0.1, -1, 0.6}, 1, 70};
const LimbKey kRightOnFoot{{-0.1, 0, 0.181}, {-0.25, 0.7, 1}, 0, 0};
const LimbKey kOnToes{{0.1, 0.005, -0.805}, {0.1, -1, 0.8}, 0, 88};

std::vector<RiseKey> from_knees(double begin) {
  const LimbKey right_hand{{-0.24, 0.03, 0.255}, {-1, 0.2, -0.6}, 0, 0};
  const auto at = [begin](double time) { return begin + time; };
  return {{at(0), {0, 0.5, -0.335}, 80, 0, 8, -25, both(kHandOnGround), both(kKneeling)},
          {at(0.25),
           {0.02, 0.5, -0.335},
           79,
           0,
           10,
           -25,
           {kHandOnGround, right_hand},
           {kOnToes, LimbKey{{-0.14, 0.13, -0.645}, {-0.4, -0.8, 0.8}, 1, 50}}},
          {at(0.6),
           {0.03, 0.505, -0.335},
           77,
           0,
           14,
           -25,
           {kHandOnGround, right_hand},
           {kOnToes, LimbKey{{-0.17, 0.2, -0.245}, {-0.6, 0, 1}, 1, 25}}},
          {at(0.95),
           {0.01, 0.5, -0.305},
           72,
           0,
           16,
           -25,
           {kHandOnGround, right_hand},
           {kOnToes, kRightOnFoot}},
          {at(1.45),
           {-0.01, 0.51, -0.245},
           38,
           0,
           14,
           -12,
           {LimbKey{{0.3, 0.38, 0.135}, {0.8, 0, -1}, 1, 0},
            LimbKey{{-0.14, 0.58, 0.155}, {-1, 0.1, -0.5}, 0.7, 0}},
           {kOnToes, kRightOnFoot}},
          {at(1.95),
           {-0.03, 0.66, -0.075},
           46,
           0,
           14,
           -25,
           {LimbKey{{0.27, 0.4, 0.255}, {0.7, 0, -1}, 1, 0},
            LimbKey{{-0.14, 0.6, 0.225}, {-1, 0.2, -0.6}, 0.8, 0}},
           {LimbKey{{0.1, 0.005, -0.805}, {0.1, -0.3, 1}, 0, 78}, kRightOnFoot}},
          {at(2.4),
           {-0.03, 0.8, 0.045},
           30,
           0,
           12,
           -20,
           {LimbKey{{0.27, 0.58, 0.255}, {0.7, 0, -1}, 1, 0},
            LimbKey{{-0.22, 0.64, 0.275}, {-1, 0.1, -0.8}, 1, 0}},
           {LimbKey{{0.1, 0.06, -0.545}, {0.1, 0, 1}, 0, 70}, kRightOnFoot}},
          {at(2.85),
           {-0.015, 0.915, 0.115},
           11,
           0,
           6,
           -8,
           {LimbKey{{0.28, 0.75, 0.195}, {0.6, 0, -1}, 1, 0},
            LimbKey{{-0.28, 0.75, 0.195}, {-0.6, 0, -1}, 1, 0}},
           {LimbKey{{0.1, 0.07, 0.005}, {0.1, 0, 1}, 0, 22}, kRightOnFoot}},
          {at(3.2),
           {0, 0.945, 0.135},
           3,
           0,
           2,
           0,
           {LimbKey{{0.28, 0.8, 0.135}, {0.5, 0, -1}, 1, 0},
            LimbKey{{-0.28, 0.8, 0.135}, {-0.5, 0, -1}, 1, 0}},
           {LimbKey{{0.0875, 0, 0.181}, {0.1, 0, 1}, 0, 0}, kRightOnFoot}},
          {at(3.8),
           {0, 0.945, 0.135},
           2,
           0,
           2,
           0,
           {LimbKey{{0.28, 0.8, 0.135}, {0.5, 0, -1}, 1, 0},
            LimbKey{{-0.28, 0.8, 0.135}, {-0.5, 0, -1}, 1, 0}},
           {LimbKey{{0.0875, 0, 0.181}, {0.1, 0, 1}, 0, 0}, kRightOnFoot}}};
}

std::vector<RiseKey> front() {
  const LimbKey straight{{0.11, 0.09, -0.87}, {0.1, -1, 0.1}, 1, 68};
  std::vector<RiseKey> keys = {
      {0,
       {0, 0.115, 0},
       90,
       0,
       0,
       -22,
       both({{0.36, 0.035, 0.6}, {1, -0.1, -0.6}, 0, 0}),
       both(straight)},
      {0.35,
       {0, 0.115, 0},
       90,
       0,
       -2,
       -30,
       both({{0.33, 0.05, 0.45}, {1, 0.5, -0.6}, 0, 0}),
       both(straight)},
      {0.7, {0, 0.12, -0.01}, 89, 0, -4, -32, both(kHandOnGround), both(straight)},
      {1.15,
       {0, 0.25, -0.04},
       74,
       0,
       -6,
       -30,
       both(kHandOnGround),
       both({{0.1, 0.09, -0.87}, {0.1, -1, 0.2}, 1, 70})}};
  for (const RiseKey& key : from_knees(1.7)) keys.push_back(key);
  return keys;
}

std::vector<RiseKey> back() {
  // The feet stay from the second key on.
  const LimbKey foot{{0.1, 0, 0.5}, {0.15, 1, 0.3}, 0, 0};
  const LimbKey right_foot{{-0.1, 0, 0.5}, {-0.15, 1, 0.3}, 0, 0};
  const LimbKey behind{{0.3, 0.03, -0.28}, {0.8, 0.3, -1}, 0, 0};
  const LimbKey right_behind{{-0.3, 0.03, -0.28}, {-0.8, 0.3, -1}, 0, 0};
  const double stand = 0.454;
  return {{0,
           {0, 0.115, 0},
           -90,
           0,
           0,
           4,
           both({{0.33, 0.03, 0.05}, {1, 0.2, -0.4}, 0, 0}),
           both({{0.1, 0.09, 0.86}, {0.2, 1, 0}, 1, 25})},
          {0.4,
           {0, 0.115, 0},
           -88,
           0,
           6,
           18,
           both({{0.33, 0.03, 0.02}, {1, 0.2, -0.4}, 0, 0}),
           both({{0.1, 0.1, 0.62}, {0.2, 1, 0}, 1, 10})},
          {0.75,
           {0, 0.115, 0},
           -80,
           0,
           22,
           28,
           both({{0.32, 0.03, -0.08}, {1, 0.2, -0.6}, 0, 0}),
           both(foot)},
          {1.3, {0, 0.115, 0}, -42, 0, 40, 16, both(behind), both(foot)},
          {1.7,
           {0.01, 0.125, 0.03},
           -8,
           0,
           44,
           0,
           {LimbKey{{0.3, 0.03, -0.12}, {0.8, 0.3, -1}, 0, 0},
            LimbKey{{-0.26, 0.4, 0.4}, {-1, -0.4, -0.4}, 1, 0}},
           {foot, right_foot}},
          {2.15,
           {0.01, 0.25, 0.17},
           32,
           0,
           40,
           -20,
           {LimbKey{{0.3, 0.05, 0.02}, {0.8, 0.3, -1}, 0, 0},
            LimbKey{{-0.2, 0.5, 0.72}, {-1, -0.4, -0.3}, 1, 0}},
           {foot, right_foot}},
          {2.55,
           {0, 0.42, 0.23},
           48,
           0,
           30,
           -35,
           {LimbKey{{0.24, 0.4, 0.62}, {1, -0.4, -0.3}, 1, 0},
            LimbKey{{-0.22, 0.5, 0.74}, {-1, -0.4, -0.3}, 1, 0}},
           {foot, right_foot}},
          {3.0,
           {0, 0.68, 0.31},
           42,
           0,
           22,
           -30,
           both({{0.24, 0.56, 0.7}, {1, -0.3, -0.5}, 1, 0}),
           {LimbKey{{0.1, 0, 0.5}, {0.15, 0.4, 1}, 0, 0},
            LimbKey{{-0.1, 0, 0.5}, {-0.15, 0.4, 1}, 0, 0}}},
          {3.5,
           {0, 0.885, 0.41},
           16,
           0,
           10,
           -10,
           both({{0.27, 0.72, 0.52}, {0.7, -0.1, -1}, 1, 0}),
           both({{0.1, 0, 0.5}, {0.1, 0.2, 1}, 0, 0})},
          {3.9,
           {0, 0.945, stand},
           4,
           0,
           2,
           0,
           both({{0.28, 0.8, stand}, {0.5, 0, -1}, 1, 0}),
           both({{0.1, 0, 0.5}, {0.1, 0, 1}, 0, 0})},
          {4.4,
           {0, 0.945, stand},
           2,
           0,
           2,
           0,
           both({{0.28, 0.8, stand}, {0.5, 0, -1}, 1, 0}),
           both({{0.1, 0, 0.5}, {0.1, 0, 1}, 0, 0})}};
}

std::vector<RiseKey> side() {
  std::vector<RiseKey> keys = {{0,
                                {0, 0.17, 0},
                                80,
                                -86,
                                10,
                                4,
                                {LimbKey{{-0.42, 0.045, 0.62}, {-0.2, -0.2, -1}, 0.6, 0},
                                 LimbKey{{-0.34, 0.06, 0.36}, {0.1, 1, -0.4}, 0.3, 0}},
                                {LimbKey{{-0.06, 0.06, -0.74}, {-1, -0.1, 0.2}, 1, 40},
                                 LimbKey{{-0.02, 0.2, -0.76}, {-1, 0.1, 0.2}, 1, 40}}},
                               {0.45,
                                {0.01, 0.17, 0},
                                82,
                                -70,
                                10,
                                -6,
                                {LimbKey{{-0.3, 0.045, 0.56}, {0.1, -0.2, -1}, 0.4, 0},
                                 LimbKey{{-0.36, 0.04, 0.33}, {-0.4, 1, -0.4}, 0, 0}},
                                {LimbKey{{-0.04, 0.07, -0.74}, {-0.9, -0.3, 0.3}, 1, 50},
                                 LimbKey{{-0.08, 0.16, -0.75}, {-1, -0.1, 0.3}, 1, 50}}},
                               {0.95,
                                {0, 0.19, -0.06},
                                82,
                                -34,
                                4,
                                -20,
                                {LimbKey{{0.12, 0.04, 0.42}, {0.7, 0.3, -0.8}, 0, 0},
                                 LimbKey{{-0.3, 0.03, 0.255}, {-0.9, 0.6, -0.5}, 0, 0}},
                                {LimbKey{{0.05, 0.09, -0.75}, {-0.2, -1, 0.5}, 1, 62},
                                 LimbKey{{-0.13, 0.11, -0.76}, {-0.6, -0.9, 0.5}, 1, 62}}},
                               {1.4,
                                {0, 0.36, -0.14},
                                78,
                                -8,
                                0,
                                -27,
                                {LimbKey{{0.24, 0.03, 0.255}, {1, 0.3, -0.6}, 0, 0},
                                 LimbKey{{-0.24, 0.03, 0.255}, {-1, 0.3, -0.6}, 0, 0}},
                                both({{0.1, 0.085, -0.82}, {0.1, -1, 0.4}, 1, 68})}};
  for (const RiseKey& key : from_knees(1.9)) keys.push_back(key);
  return keys;
}

}  // namespace

std::span<const RiseKey> rise_keys(Lying from) {
  static const std::vector<RiseKey> kFront = front(), kBack = back(), kSide = side();
  return from == Lying::front ? kFront : from == Lying::back ? kBack : kSide;
}

}  // namespace krok::samples
