#include "filter/rotation_series.h"

#include <vector>

#include "math/quaternion.h"

namespace krok::filter {

void smooth_positions(const SeriesFilter& filter, std::span<Vec3> series) {
  const std::size_t size = series.size();
  if (size < 3) return;
  const Vec3 first = series.front();
  const Vec3 step = (series.back() - first) / static_cast<double>(size - 1);
  std::vector<double> values(size);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t t = 0; t < size; ++t) {
      values[t] = series[t][axis] - (first[axis] + static_cast<double>(t) * step[axis]);
    }
    filter(values);
    for (std::size_t t = 0; t < size; ++t) {
      series[t][axis] = values[t] + (first[axis] + static_cast<double>(t) * step[axis]);
    }
  }
}

void smooth_rotations(const SeriesFilter& filter, std::span<Quat> series) {
  const std::size_t size = series.size();
  if (size < 3) return;
  constexpr int kRounds = 3;
  const std::vector<Quat> data(series.begin(), series.end());
  std::vector<Vec3> rolled_out(size), filtered(size);
  for (int round = 0; round < kRounds; ++round) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t t = 0; t < size; ++t) {
      if (t > 0) sum += rotation_vector(series[t - 1].conjugate() * series[t]);
      rolled_out[t] = sum;
      filtered[t] = sum + rotation_vector(series[t].conjugate() * data[t]);
    }
    smooth_positions(filter, filtered);
    for (std::size_t t = 0; t < size; ++t) {
      series[t] =
          normalized_or_identity(series[t] * from_rotation_vector(filtered[t] - rolled_out[t]));
    }
  }
}

}  // namespace krok::filter
