#include "formats/bvh/half_angle.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace krok::bvh {

using namespace half_angle_detail;

double near_angle(double degrees) {
  return std::fmod(degrees, 720.0);
}

HalfAngle half_angle(double degrees) {
  if (std::abs(degrees) > kFarthestAngle) degrees = near_angle(degrees);
  const double rounding = degrees * kHalfTurns + kRounder;
  const double half_turns = rounding - kRounder;
  const auto quarter = std::bit_cast<std::uint64_t>(rounding);  // of the half angle
  const double t = (degrees - half_turns * 180.0) * kHalfRadians;
  const double square = t * t;
  double p = kSine[0];
  double q = kCosine[0];
  for (int i = 1; i < 6; ++i) {
    p = p * square + kSine[i];
    q = q * square + kCosine[i];
  }
  double sine = t + t * square * p;
  double cosine = 1.0 - (0.5 * square - square * square * q);
  if ((quarter & 1) != 0) {
    std::swap(sine, cosine);
    cosine = -cosine;
  }
  return (quarter & 2) != 0 ? HalfAngle{-sine, -cosine} : HalfAngle{sine, cosine};
}

}  // namespace krok::bvh
