#include "gait/slope_gait_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/hermite.h"
#include "math/transform.h"

namespace krok::gait {

namespace {

constexpr double kDegree = kRadiansPerDegree;
constexpr double kMaxChange = 15 * kDegree;  // steeper slopes change no more
constexpr double kTilt = 0.5;                // of the grade: of the line from hip to ankle
// Per radian: in mid-stance knees of 20 degrees 7.5 degrees downhill and of 18 uphill, of 11 on the
// level.
constexpr double kLowerDown = 0.18, kLowerUp = 0.1;
constexpr double kLeanUp = 0.6, kLeanDown = 0.25;  // of the grade
constexpr double kMaxLeanUp = 8 * kDegree, kMaxLeanDown = 3 * kDegree;
constexpr double kLessPitch = 0.015 / kDegree;  // of the landing foot's, uphill
// A sole less inclined than the way by so much stands on a tread, and for sure by as much more.
constexpr double kTread = 8 * kDegree, kSureTread = 10 * kDegree;
constexpr double kToesDown = 20 * kDegree, kToesDownUp = 8 * kDegree;  // down, and up stairs

// Duration of a stride relative to the level's, every 3 degrees from -15 to 15; beyond 9 degrees
// as at 9.
constexpr std::array<double, 11> kDurations = {0.94, 0.94, 0.94, 0.95, 0.98, 1,
                                               1.02, 1.02, 1.01, 1.01, 1.01};

double duration_at(double grade) {
  const double place = std::clamp(grade / (3 * kDegree) + 5, 0.0, 10.0);
  const auto i = std::min(static_cast<std::size_t>(place), kDurations.size() - 2);
  return std::lerp(kDurations[i], kDurations[i + 1], place - static_cast<double>(i));
}

}  // namespace

SlopeGait slope_gait(double grade, double sole) {
  SlopeGait gait;
  const double tread = smoother_step((std::abs(grade - sole) - kTread) / kSureTread);
  const double slope = (1 - tread) * std::clamp(grade, -kMaxChange, kMaxChange);
  gait.duration = duration_at(slope);
  gait.length = std::min(gait.duration, 1.0);
  gait.ahead = -std::tan(kTilt * slope);
  gait.lower = slope < 0 ? -kLowerDown * slope : kLowerUp * slope;
  gait.lean = grade > 0 ? std::min(kLeanUp * grade, kMaxLeanUp)
                        : std::max(kLeanDown * grade, -kMaxLeanDown);
  gait.landing = 1 - kLessPitch * std::max(slope, 0.0);
  gait.forefoot = tread;
  gait.toes_down = grade > 0 ? kToesDownUp : kToesDown;
  return gait;
}

}  // namespace krok::gait
