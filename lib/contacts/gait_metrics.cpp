#include "contacts/gait_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace krok {

namespace {

constexpr double kLongest = 3;  // seconds

}  // namespace

std::vector<GaitCycle> gait_cycles(const std::vector<Keytime>& keytimes, FootSide side) {
  const std::string foot = name_of(side);
  std::vector<GaitCycle> cycles;
  double strike = -1, off = -1;
  for (const Keytime& key : keytimes) {
    if (key.name == foot + "_off") {
      off = key.time;
    } else if (key.name == foot + "_strike") {
      if (strike >= 0 && off > strike && key.time - strike < kLongest) {
        cycles.push_back({strike, off, key.time});
      }
      strike = key.time;
    }
  }
  return cycles;
}

std::vector<StanceTimes> stance_times(const std::vector<Keytime>& keytimes, FootSide side) {
  const std::string foot = name_of(side);
  std::vector<StanceTimes> stances;
  const Keytime* strike = nullptr;
  for (const Keytime& key : keytimes) {
    if (key.name == foot + "_strike") strike = &key;
    if (key.name != foot + "_off" || strike == nullptr) continue;
    stances.push_back({strike->time, key.time});
    strike = nullptr;
  }
  return stances;
}

GaitMetrics gait_metrics(const std::vector<Keytime>& keytimes) {
  GaitMetrics metrics;
  const std::array<std::vector<GaitCycle>, 2> cycles = {gait_cycles(keytimes, FootSide::left),
                                                        gait_cycles(keytimes, FootSide::right)};
  double length = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    for (const GaitCycle& cycle : cycles[s]) {
      ++metrics.cycles;
      length += cycle.next - cycle.strike;
      metrics.stance[s] += (cycle.off - cycle.strike) / (cycle.next - cycle.strike);
    }
    if (!cycles[s].empty()) metrics.stance[s] /= static_cast<double>(cycles[s].size());
  }
  if (metrics.cycles == 0) return metrics;
  metrics.cycle = length / metrics.cycles;
  metrics.cadence = 120 / metrics.cycle;
  // Double support is the excess of both stance fractions over 1, which needs no pairing of cycles
  // at the clip's ends.
  if (!cycles[0].empty() && !cycles[1].empty()) {
    metrics.double_support = std::max(0.0, metrics.stance[0] + metrics.stance[1] - 1);
  }
  return metrics;
}

namespace {

constexpr double kLowCadence = 25, kHighCadence = 260;  // steps per minute
constexpr double kDifferent = 0.15;                     // of the cycle
constexpr double kSlowest = 0.3;                        // metres per second
constexpr double kWalk = 0.25, kRun = 1;                // Froude numbers
constexpr double kGravity = 9.81;                       // metres per second squared
constexpr double kLongestInRuns = 0.6, kDown = 0.9;     // of the cycle

std::string fault(const GaitMetrics& metrics, double speed, double leg_length) {
  const double left = metrics.stance[0], right = metrics.stance[1];
  if (metrics.cadence < kLowCadence || metrics.cadence > kHighCadence) {
    return fmt::format("{:.0f} steps per minute", metrics.cadence);
  }
  const bool both = left > 0 && right > 0;
  if (both && std::abs(left - right) > kDifferent) {
    return fmt::format("the left foot is down for {:.0f} % of a cycle, the right one for {:.0f} %",
                       100 * left, 100 * right);
  }
  const double stance = both ? 0.5 * (left + right) : left + right;
  const double froude = speed * speed / (kGravity * leg_length);
  const std::string gait = fmt::format(
      "at {:.1f} m/s and {:.0f} steps per minute feet are down for "
      "{:.0f} % of a cycle",
      speed, metrics.cadence, 100 * stance);
  if (speed > kSlowest && froude < kWalk && stance < 0.5) return gait + ", without double support";
  if (froude > kRun && stance > kLongestInRuns) return gait;
  return speed > kSlowest && stance > kDown ? gait : std::string();
}

}  // namespace

Diagnostics check_gait(const GaitMetrics& metrics, double speed, double leg_length) {
  Diagnostics warnings;
  if (metrics.cycles < 2 || !(leg_length > 0)) return warnings;
  const std::string text = fault(metrics, speed, leg_length);
  if (text.empty()) return warnings;
  warnings.push_back(
      make_warning("gait-implausible", "the keytimes are not those of people: " + text,
                   metrics.cadence > kHighCadence
                       ? "the frame rate may be too high; set that of the capture with --fps N"
                       : "an event is missing or misplaced; check them with krok-keys --plot"));
  return warnings;
}

}  // namespace krok
