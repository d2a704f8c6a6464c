#include "contacts/gait_metrics.h"

#include <algorithm>
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

}  // namespace krok
