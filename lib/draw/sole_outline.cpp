#include "draw/sole_outline.h"

#include <array>

namespace krok::draw {

namespace {

constexpr int kPieces = 4;  // of the curve between two knots

// Round the sole, over its outer side to the toes and back.
constexpr std::array<std::array<double, 2>, 16> kKnots = {{{0, 0},
                                                           {0.09, 0.025},
                                                           {0.125, 0.12},
                                                           {0.12, 0.3},
                                                           {0.145, 0.5},
                                                           {0.175, 0.67},
                                                           {0.15, 0.83},
                                                           {0.06, 0.96},
                                                           {-0.05, 1},
                                                           {-0.13, 0.93},
                                                           {-0.16, 0.8},
                                                           {-0.155, 0.68},
                                                           {-0.105, 0.5},
                                                           {-0.085, 0.3},
                                                           {-0.11, 0.12},
                                                           {-0.085, 0.025}}};

}  // namespace

// Catmull and Rom's curve through the knots.
std::vector<Vec2> sole_outline() {
  const auto knot = [](std::size_t i) {
    const auto& [x, y] = kKnots[i % kKnots.size()];
    return Vec2(x, y);
  };
  std::vector<Vec2> outline;
  for (std::size_t i = 0; i < kKnots.size(); ++i) {
    const Vec2 a = knot(i + kKnots.size() - 1), b = knot(i), c = knot(i + 1), d = knot(i + 2);
    for (int k = 0; k < kPieces; ++k) {
      const double t = static_cast<double>(k) / kPieces;
      outline.push_back(0.5 * (2 * b + t * (c - a) + t * t * (2 * a - 5 * b + 4 * c - d) +
                               t * t * t * (3 * b - a - 3 * c + d)));
    }
  }
  return outline;
}

}  // namespace krok::draw
