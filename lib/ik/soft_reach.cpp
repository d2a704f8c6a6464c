#include "ik/soft_reach.h"

#include <algorithm>
#include <cmath>

#include "math/window.h"

namespace krok {

int softening_reach(double rate) {
  constexpr double kMax = 256;  // reached only at thousands of fps
  return static_cast<int>(std::lround(std::min(0.12 * rate, kMax)));
}

std::vector<double> softness_of(std::vector<double> lacks, double length, double rate) {
  constexpr double kSoftness = 1.5, kMax = 0.06;
  for (double& metres : lacks) metres = std::min(kSoftness * metres, kMax * length);
  return softened_if_any(std::move(lacks), softening_reach(rate));
}

}  // namespace krok
