#include "contacts/hip_widths.h"

#include <cmath>

#include "math/hermite.h"

namespace krok {

double beside_for_hips(double width, double other_width, double leg) {
  constexpr double kUsual = 0.06, kOther = 0.12;  // of the leg
  const double wider = 0.5 * (width - other_width);
  const double share = (std::abs(wider) - kUsual * leg) / ((kOther - kUsual) * leg);
  return leg > 0 ? smoother_step(share) * wider : 0;
}

}  // namespace krok
