#pragma once

#include <algorithm>

namespace krok {

// From 0 at s = 0 to 1 at s = 1 with two derivatives zero at both ends, clamped beyond: the quintic
// along which people reach (Flash and Hogan, "The coordination of arm movements", 1985).
inline double smoother_step(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

}  // namespace krok
