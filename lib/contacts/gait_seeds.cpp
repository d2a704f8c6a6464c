#include <algorithm>
#include <cmath>

#include "contacts/gait_seeds_internal.h"
#include "contacts/series_internal.h"

namespace krok::contacts {

Seeds turning_points(const std::vector<double>& curve, double rate, double least) {
  Seeds seeds;
  if (curve.empty()) return seeds;
  std::size_t high = 0, low = 0;
  int direction = 0;
  for (std::size_t f = 0; f < curve.size(); ++f) {
    if (curve[f] > curve[high]) high = f;
    if (curve[f] < curve[low]) low = f;
    if (direction >= 0 && curve[high] - curve[f] > least) {
      if (direction > 0 || high > 0) seeds.front.push_back(static_cast<double>(high) / rate);
      direction = -1;
      low = f;
    } else if (direction <= 0 && curve[f] - curve[low] > least) {
      if (direction < 0 || low > 0) seeds.back.push_back(static_cast<double>(low) / rate);
      direction = 1;
      high = f;
    }
    if (direction > 0 && curve[f] >= curve[high]) high = f;
    if (direction < 0 && curve[f] <= curve[low]) low = f;
  }
  return seeds;
}

double cycle_of(const Seeds& seeds) {
  std::vector<double> cycles;
  for (const auto* list : {&seeds.front, &seeds.back}) {
    for (std::size_t i = 1; i < list->size(); ++i) cycles.push_back((*list)[i] - (*list)[i - 1]);
  }
  return cycles.empty() ? kUsualCycle : std::clamp(middle(cycles), 0.4, 2.5);
}

bool is_seeded(const Seeds& seeds, double time, double cycle) {
  double before = -1e9, after = 1e9;
  for (const auto* list : {&seeds.front, &seeds.back}) {
    for (const double seed : *list) {
      if (seed <= time) before = std::max(before, seed);
      if (seed >= time) after = std::min(after, seed);
    }
  }
  return after - before < cycle;
}

}  // namespace krok::contacts
