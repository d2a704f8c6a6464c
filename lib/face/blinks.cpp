#include "face/blinks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "timeline/easing.h"

namespace krok::face {

namespace {

constexpr double kSigma = 0.5;

// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  // More than 0, less than 1.
  double uniform() {
    std::uint64_t value = state_ += 0x9e3779b97f4a7c15u;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    return (static_cast<double>((value ^ (value >> 31)) >> 12) + 0.5) * 0x1p-52;
  }
  // Box and Muller.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace

std::vector<double> blink_times(double duration, const BlinkOptions& options) {
  std::vector<double> times;
  Random random(options.seed);
  const double mean = 60 / options.per_minute;
  const double length = options.closing + options.closed + options.opening;
  const auto interval = [&] {
    return std::max(length, mean * std::exp(kSigma * random.normal() - 0.5 * kSigma * kSigma));
  };
  for (double time = interval() * random.uniform(); time <= duration; time += interval()) {
    times.push_back(time);
  }
  return times;
}

double blink_at(double seconds, const std::vector<double>& times, const BlinkOptions& options) {
  const auto after = std::ranges::upper_bound(times, seconds);
  if (after == times.begin()) return 0;
  const double since = seconds - *(after - 1);
  return timeline::Easing().at(since / options.closing) -
         timeline::Easing().at((since - options.closing - options.closed) / options.opening);
}

}  // namespace krok::face
