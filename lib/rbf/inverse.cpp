#include "rbf/inverse.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace krok::rbf {

namespace {

// At most kMaxDimensions: these stay on the stack.
using SmallMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDimensions, kMaxDimensions>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDimensions, 1>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRidge = 1e-12;  // relative; keeps directions without effect from being singular
constexpr int kMaxHalvings = 4;   // of a Gauss-Newton step
constexpr double kBeyond = 0.5;   // of the range: how far outside it a point may move
constexpr double kMinDamping = 1e-6, kMaxDamping = 1e6;

}  // namespace

InverseSearch::InverseSearch(const WeightEvaluator& evaluator, Measure measure)
    : evaluator_(evaluator),
      measure_(std::move(measure)),
      d_(static_cast<std::size_t>(evaluator.dimensions())),
      n_(static_cast<std::size_t>(evaluator.examples())),
      parameters_(d_),
      jacobian_(d_ * n_),
      error_(d_),
      tried_error_(d_),
      weights_(n_),
      slopes_(d_ * n_),
      direction_(n_),
      point_(d_) {}

double InverseSearch::measure_at(std::span<const double> weights, std::span<const double> wanted,
                                 bool slopes, std::vector<double>& error) {
  ++measured_;
  const Status status =
      measure_(weights, parameters_, slopes ? std::span<double>(jacobian_) : std::span<double>());
  if (!status) return kInfinity;
  double square = 0;
  for (std::size_t a = 0; a < d_; ++a) {
    const double scale = evaluator_.inverse_ranges()[a];
    error[a] = (wanted[a] - parameters_[a]) * scale;
    square += error[a] * error[a];
    if (!slopes) continue;
    for (std::size_t j = 0; j < n_; ++j) {
      jacobian_[a * n_ + j] *= scale;
      if (!std::isfinite(jacobian_[a * n_ + j])) return kInfinity;
    }
  }
  return std::isfinite(square) ? std::sqrt(square) : kInfinity;
}

double InverseSearch::measure_point(std::span<const double> point, std::span<const double> wanted,
                                    bool slopes, std::vector<double>& error) {
  if (slopes) {
    evaluator_.slopes(point, weights_, slopes_);
  } else {
    evaluator_.weights(point, weights_);
  }
  return measure_at(weights_, wanted, slopes, error);
}

Match InverseSearch::correct(std::span<const double> wanted, int steps, double enough,
                             std::span<double> weights) {
  measured_ = 0;
  double now = measure_at(weights, wanted, true, error_);
  const double before = now;
  const auto d = static_cast<Eigen::Index>(d_);
  for (int step = 0; step < steps && now > enough && std::isfinite(now); ++step) {
    // Minimum-norm change to first order that keeps the sum: J minus its row mean.
    for (std::size_t a = 0; a < d_; ++a) {
      double mean = 0;
      for (std::size_t j = 0; j < n_; ++j) mean += jacobian_[a * n_ + j];
      mean /= static_cast<double>(n_);
      for (std::size_t j = 0; j < n_; ++j) jacobian_[a * n_ + j] -= mean;
    }
    SmallMatrix normal = SmallMatrix::Zero(d, d);
    for (std::size_t a = 0; a < d_; ++a) {
      for (std::size_t b = 0; b < d_; ++b) {
        double sum = 0;
        for (std::size_t j = 0; j < n_; ++j) sum += jacobian_[a * n_ + j] * jacobian_[b * n_ + j];
        normal(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = sum;
      }
    }
    normal.diagonal().array() += kRidge * (normal.trace() + std::numeric_limits<double>::min());
    const SmallVector factors =
        normal.ldlt().solve(Eigen::Map<const SmallVector>(error_.data(), d));
    std::ranges::fill(direction_, 0.0);
    for (std::size_t a = 0; a < d_; ++a) {
      const double factor = factors[static_cast<Eigen::Index>(a)];
      for (std::size_t j = 0; j < n_; ++j) direction_[j] += factor * jacobian_[a * n_ + j];
    }
    const bool last = step + 1 == steps;
    double part = 1, tried = kInfinity;
    for (int halving = 0; halving < kMaxHalvings; ++halving, part *= 0.5) {
      for (std::size_t j = 0; j < n_; ++j) weights_[j] = weights[j] + part * direction_[j];
      tried = measure_at(weights_, wanted, !last, tried_error_);
      if (tried < now) break;
    }
    if (!(tried < now)) break;
    std::ranges::copy(weights_, weights.begin());
    error_.swap(tried_error_);
    now = tried;
  }
  return {before, now, measured_};
}

Match InverseSearch::find_point(std::span<const double> wanted, int steps, double enough,
                                std::span<double> point) {
  measured_ = 0;
  double now = measure_point(point, wanted, true, error_);
  const double before = now;
  const auto d = static_cast<Eigen::Index>(d_);
  double damping = 1e-3;
  SmallMatrix slope = SmallMatrix::Zero(d, d);
  bool fresh = true;
  for (int step = 0; step < steps && now > enough && std::isfinite(now); ++step) {
    if (fresh) {
      // By scaled parameters.
      for (std::size_t a = 0; a < d_; ++a) {
        for (std::size_t b = 0; b < d_; ++b) {
          double sum = 0;
          for (std::size_t j = 0; j < n_; ++j) sum += jacobian_[a * n_ + j] * slopes_[b * n_ + j];
          slope(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
              sum / evaluator_.inverse_ranges()[b];
        }
      }
    }
    SmallMatrix normal = slope.transpose() * slope;
    normal.diagonal().array() +=
        damping * (normal.trace() / static_cast<double>(d_) + std::numeric_limits<double>::min());
    const SmallVector right = slope.transpose() * Eigen::Map<const SmallVector>(error_.data(), d);
    const SmallVector change = normal.ldlt().solve(right);
    for (std::size_t a = 0; a < d_; ++a) {
      const double range = 1 / evaluator_.inverse_ranges()[a];
      const double low = evaluator_.lower()[a];
      point_[a] = std::clamp(point[a] + change[static_cast<Eigen::Index>(a)] * range,
                             low - kBeyond * range, low + (1 + kBeyond) * range);
    }
    const double tried = measure_point(point_, wanted, true, tried_error_);
    fresh = tried < now;
    if (fresh) {
      std::ranges::copy(point_, point.begin());
      error_.swap(tried_error_);
      const bool slow = tried > 0.999 * now;
      now = tried;
      damping = std::max(damping * 0.1, kMinDamping);
      if (slow) break;
    } else {
      damping *= 10;
      if (damping > kMaxDamping) break;
    }
  }
  return {before, now, measured_};
}

}  // namespace krok::rbf
