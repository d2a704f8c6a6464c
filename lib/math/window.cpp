#include "math/window.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "core/index.h"

namespace krok {

namespace {

constexpr int kRounds = 100;
constexpr double kConverged = 1e-9, kTogether = 1e-6, kNear = 0.01;  // metres
constexpr double kMaxNewton = 20;                                    // of the other step

// `kMaxPoints`: for arrays on the stack, or Eigen::Dynamic.
template <int kMaxPoints>
Vec3 median_of(std::span<const Vec3> points) {
  // A row for each axis, as wide operations want them.
  using Points = Eigen::Array<double, Eigen::Dynamic, 3, Eigen::ColMajor, kMaxPoints, 3>;
  const Points all = Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3,
                                                        static_cast<Eigen::Index>(points.size()))
                         .transpose();
  Points off(all.rows(), 3), cubed(all.rows(), 3);
  Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxPoints, 1> weights(all.rows());
  Vec3 center = all.colwise().mean();
  double last = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    off = all.rowwise() - center.transpose().array();
    weights = (off.square().rowwise().sum() + kTogether * kTogether).rsqrt();
    const Vec3 sum = off.matrix().transpose() * weights.matrix();
    const double total = weights.sum();
    cubed = off.colwise() * weights.cube();
    const Mat3 across = cubed.matrix().transpose().lazyProduct(off.matrix());
    Vec3 step = sum / total;  // Weiszfeld's
    // Newton's near the end, while it converges.
    const Vec3 newton = (total * Mat3::Identity() - across).inverse() * sum;
    if (step.norm() < kNear && newton.norm() < std::min(last, kMaxNewton * step.norm())) {
      step = newton;
    }
    center += step;
    last = step.norm();
    if (last < kConverged) break;
  }
  return center;
}

}  // namespace

double median(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  if (values.size() % 2 == 1) return *half;
  return 0.5 * (*half + *std::max_element(values.begin(), half));
}

double upper_median(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

std::vector<double> max_within(std::span<const double> values, int reach) {
  std::vector<double> result(values.size());
  std::deque<std::size_t> falling;  // of the window, those with nothing higher behind them
  const std::size_t n = values.size(), r = static_cast<std::size_t>(reach);
  std::size_t next = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (; next < std::min(n, i + r + 1); ++next) {
      while (!falling.empty() && values[falling.back()] <= values[next]) falling.pop_back();
      falling.push_back(next);
    }
    while (falling.front() + r < i) falling.pop_front();
    result[i] = values[falling.front()];
  }
  return result;
}

std::vector<double> softened(std::span<const double> values, int reach) {
  const int count = static_cast<int>(values.size());
  const std::vector<double> widened = max_within(values, reach);
  std::vector<double> result(values.size());
  std::vector<double> weights;
  double all = 0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(1 + std::cos(kPi * k / (reach + 1)));
    all += weights.back();
  }
  for (int i = 0; i < count; ++i) {
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) {
      sum += weights[at(k + reach)] * widened[at(std::clamp(i + k, 0, count - 1))];
    }
    result[at(i)] = sum / all;
  }
  return result;
}

std::vector<double> softened_if_any(std::vector<double> values, int reach) {
  if (std::ranges::all_of(values, [](double value) { return value == 0; })) return {};
  return softened(values, reach);
}

std::vector<double> mean_within(std::span<const double> values, int reach) {
  const int n = static_cast<int>(values.size());
  std::vector<double> result(values.size());
  for (int i = 0; i < n; ++i) {
    double sum = 0;
    for (int k = i - reach; k <= i + reach; ++k) {
      sum += values[static_cast<std::size_t>(std::clamp(k, 0, n - 1))];
    }
    result[static_cast<std::size_t>(i)] = sum / (2 * reach + 1);
  }
  return result;
}

Vec3 median_point(std::span<const Vec3> points) {
  constexpr int kFew = 64;
  if (points.empty()) return Vec3::Zero();
  return points.size() <= kFew ? median_of<kFew>(points) : median_of<Eigen::Dynamic>(points);
}

Vec3 median_place(std::span<const Vec3> points) {
  if (points.empty()) return Vec3::Zero();
  std::vector<Vec3> level(points.begin(), points.end());
  std::vector<double> heights;
  for (Vec3& point : level) heights.push_back(std::exchange(point.y(), 0));
  Vec3 place = median_point(level);
  place.y() = median(std::move(heights));
  return place;
}

}  // namespace krok
