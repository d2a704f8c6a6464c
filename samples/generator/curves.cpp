#include "samples/generator/curves.h"

#include <algorithm>
#include <cmath>

namespace krok::samples {

double ease(double x) {
  const double u = std::clamp(x, 0.0, 1.0);
  return u * u * u * (10 + u * (-15 + 6 * u));
}

double KnotCurve::operator()(double time) const {
  if (time <= knots_.front().time) return knots_.front().value;
  if (time >= knots_.back().time) return knots_.back().value;
  std::size_t next = 1;
  while (knots_[next].time <= time) ++next;
  const Knot& a = knots_[next - 1];
  const Knot& b = knots_[next];
  return quintic<double>({a.value, a.velocity, a.acceleration},
                         {b.value, b.velocity, b.acceleration}, b.time - a.time, time - a.time);
}

PeriodicCurve::PeriodicCurve(std::span<const double> samples, int harmonics) {
  const auto count = static_cast<double>(samples.size());
  for (double sample : samples) mean_ += sample / count;
  for (int h = 1; h <= harmonics; ++h) {
    double cosine = 0;
    double sine = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double angle = 2 * kPi * h * static_cast<double>(i) / count;
      cosine += samples[i] * std::cos(angle) * 2 / count;
      sine += samples[i] * std::sin(angle) * 2 / count;
    }
    cosines_.push_back(cosine);
    sines_.push_back(sine);
  }
}

double PeriodicCurve::operator()(double phase) const {
  double value = mean_;
  for (std::size_t i = 0; i < cosines_.size(); ++i) {
    const double angle = 2 * kPi * static_cast<double>(i + 1) * phase;
    value += cosines_[i] * std::cos(angle) + sines_[i] * std::sin(angle);
  }
  return value;
}

void smooth(std::vector<double>& samples, double sigma) {
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> weights;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5 * (i / sigma) * (i / sigma)));
    sum += weights.back();
  }
  const std::vector<double> before = samples;
  const int last = static_cast<int>(before.size()) - 1;
  for (int i = 0; i <= last; ++i) {
    double value = 0;
    for (int k = -reach; k <= reach; ++k) {
      value += weights[static_cast<std::size_t>(k + reach)] *
               before[static_cast<std::size_t>(std::clamp(i + k, 0, last))];
    }
    samples[static_cast<std::size_t>(i)] = value / sum;
  }
}

}  // namespace krok::samples
