#include "contacts/gait_figures.h"

#include <algorithm>
#include <string>

namespace krok {

namespace {

constexpr double kLongest = 3;  // seconds

struct Cycle {
  double strike = 0, off = 0, next = 0;
};

std::vector<Cycle> cycles_of(const std::vector<Keytime>& keytimes, const std::string& side) {
  std::vector<Cycle> cycles;
  double strike = -1, off = -1;
  for (const Keytime& key : keytimes) {
    if (key.name == side + "_off") {
      off = key.time;
    } else if (key.name == side + "_strike") {
      if (strike >= 0 && off > strike && key.time - strike < kLongest) {
        cycles.push_back({strike, off, key.time});
      }
      strike = key.time;
    }
  }
  return cycles;
}

}  // namespace

GaitFigures gait_figures(const std::vector<Keytime>& keytimes) {
  GaitFigures figures;
  const std::array<std::vector<Cycle>, 2> cycles = {cycles_of(keytimes, "left"),
                                                    cycles_of(keytimes, "right")};
  double length = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    for (const Cycle& cycle : cycles[s]) {
      ++figures.cycles;
      length += cycle.next - cycle.strike;
      figures.stance[s] += (cycle.off - cycle.strike) / (cycle.next - cycle.strike);
    }
    if (!cycles[s].empty()) figures.stance[s] /= static_cast<double>(cycles[s].size());
  }
  if (figures.cycles == 0) return figures;
  figures.cycle = length / figures.cycles;
  figures.cadence = 120 / figures.cycle;
  // A foot's cycle has two times of double support; by the stances alone they are what exceeds the
  // whole, which needs no pairing of cycles at the clip's ends.
  if (!cycles[0].empty() && !cycles[1].empty()) {
    figures.double_support = std::max(0.0, figures.stance[0] + figures.stance[1] - 1);
  }
  return figures;
}

}  // namespace krok
