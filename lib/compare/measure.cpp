#include "compare/measure.h"

#include <algorithm>
#include <cmath>

namespace krok::compare {

void Totals::merge(const Totals& later) {
  take_largest(later.largest, later.where);
  square_sum += later.square_sum;
  count += later.count;
  over += later.over;
}

double Totals::rms() const {
  return count == 0 ? 0.0 : std::sqrt(square_sum / static_cast<double>(count));
}

void Measure::merge(const Measure& later) {
  Totals::merge(later);
  spread.merge(later.spread);
}

double Measure::percentile(double share) const {
  return std::min(largest, spread.percentile(share));
}

double angle_between_directions(const Vec3& a, const Vec3& b) {
  const double length_a = a.norm();
  const double length_b = b.norm();
  if (length_a == 0 || length_b == 0) return length_a == length_b ? 0.0 : kPi;
  // Kahan's formula, "How futile are mindless assessments of roundoff", section 12: accurate at
  // both ends.
  const Vec3 u = a / length_a;
  const Vec3 v = b / length_b;
  return 2.0 * std::atan2((u - v).norm(), (u + v).norm());
}

}  // namespace krok::compare
