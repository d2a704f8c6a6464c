#include "math/wrap_time.h"

#include <algorithm>
#include <cmath>

namespace krok {

namespace {

// The remainder in [0, period). fmod of a tiny negative number plus the period may round to the
// period itself.
double remainder_from_zero(double time, double period) {
  double rest = std::fmod(time, period);
  if (rest < 0) rest += period;
  return rest < period ? rest : 0;
}

}  // namespace

double wrap_time(double time, double duration, Wrap wrap) {
  if (!(duration > 0) || !std::isfinite(duration) || std::isnan(time)) return 0;
  if (time >= 0 && time <= duration) return time;
  if (wrap == Wrap::clamp) return std::clamp(time, 0.0, duration);
  if (!std::isfinite(time)) return 0;
  if (wrap == Wrap::loop) return remainder_from_zero(time, duration);
  const double there_and_back = remainder_from_zero(time, 2 * duration);
  return there_and_back <= duration ? there_and_back : 2 * duration - there_and_back;
}

}  // namespace krok
