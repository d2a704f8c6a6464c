#include "math/median.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace krok {

namespace {

constexpr int kRounds = 100;
constexpr double kConverged = 1e-9, kTogether = 1e-6;  // metres

double median(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  if (values.size() % 2 == 1) return *half;
  return 0.5 * (*half + *std::max_element(values.begin(), half));
}

}  // namespace

Vec3 median_point(std::span<const Vec3> points) {
  Vec3 center = Vec3::Zero();
  if (points.empty()) return center;
  for (const Vec3& point : points) center += point;
  center /= static_cast<double>(points.size());
  for (int round = 0; round < kRounds; ++round) {
    Vec3 sum = Vec3::Zero();
    double weights = 0;
    for (const Vec3& point : points) {
      const double weight = 1 / std::sqrt((point - center).squaredNorm() + kTogether * kTogether);
      sum += weight * (point - center);
      weights += weight;
    }
    const Vec3 step = sum / weights;
    center += step;
    if (step.norm() < kConverged) break;
  }
  return center;
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
