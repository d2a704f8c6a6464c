#include "parametric/bounds.h"

#include <algorithm>
#include <limits>

#include "math/dense_solve.h"

namespace krok::parametric {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMinRange = 1e-9;
constexpr double kRounding = 1e-9;    // of scaled distances
constexpr double kTolerance = 1e-10;  // of squares of scaled distances

// Weights, summing to 1, of the point nearest to 0 in the affine hull of the columns.
VectorXd affine_minimum(const MatrixXd& points) {
  const Index n = points.cols();
  MatrixXd system = MatrixXd::Ones(n + 1, n + 1);
  system.topLeftCorner(n, n) = points.transpose() * points;
  system(n, n) = 0;
  VectorXd right = VectorXd::Zero(n + 1);
  right[n] = 1;
  return solve_full_pivoting(system, right).head(n);
}

// Weights of the point nearest to 0 in the convex hull of the columns. The corral is the set of
// columns whose hull contains it.
VectorXd nearest_to_origin(const MatrixXd& points) {
  Index first = 0;
  points.colwise().squaredNorm().minCoeff(&first);
  std::vector<Index> corral = {first};
  VectorXd weights = VectorXd::Ones(1);
  VectorXd nearest = points.col(first);
  const auto chosen = [&] {
    MatrixXd columns(points.rows(), static_cast<Index>(corral.size()));
    for (std::size_t i = 0; i < corral.size(); ++i) {
      columns.col(static_cast<Index>(i)) = points.col(corral[i]);
    }
    return columns;
  };
  for (Index round = 0; round < 20 * points.cols(); ++round) {
    Index next = 0;
    const double reach = (nearest.transpose() * points).minCoeff(&next);
    if (reach > nearest.squaredNorm() - kTolerance) break;
    if (std::ranges::find(corral, next) != corral.end()) break;
    corral.push_back(next);
    weights.conservativeResize(weights.size() + 1);
    weights[weights.size() - 1] = 0;
    for (;;) {
      const VectorXd wanted = affine_minimum(chosen());
      if (wanted.minCoeff() > kTolerance) {
        weights = wanted;
        break;
      }
      // Moves towards it as far as the hull reaches; columns whose weight becomes 0 are dropped.
      double part = 1;
      for (Index i = 0; i < weights.size(); ++i) {
        if (wanted[i] > kTolerance) continue;
        part = std::min(part, weights[i] / std::max(weights[i] - wanted[i], 1e-300));
      }
      weights += part * (wanted - weights);
      Index least = 0;
      weights.minCoeff(&least);
      corral.erase(corral.begin() + least);
      for (Index i = least; i + 1 < weights.size(); ++i) weights[i] = weights[i + 1];
      weights.conservativeResize(weights.size() - 1);
      if (corral.size() == 1) {
        weights[0] = 1;
        break;
      }
    }
    nearest = chosen() * weights;
  }
  return nearest;
}

}  // namespace

void Bounds::scale(std::span<const double> point, std::span<double> scaled) const {
  for (std::size_t d = 0; d < point.size(); ++d) {
    const double range = upper[d] - lower[d];
    scaled[d] = (point[d] - lower[d]) / (range > kMinRange ? range : 1);
  }
}

Bounds bounds_of(const Library& library) {
  Bounds bounds;
  bounds.dimensions = library.dimensions();
  bounds.lower = bounds.upper = library.examples.front().parameters;
  for (const Example& example : library.examples) {
    for (std::size_t d = 0; d < example.parameters.size(); ++d) {
      bounds.lower[d] = std::min(bounds.lower[d], example.parameters[d]);
      bounds.upper[d] = std::max(bounds.upper[d], example.parameters[d]);
    }
  }
  const auto dimensions = static_cast<std::size_t>(bounds.dimensions);
  for (const Example& example : library.examples) {
    bounds.points.resize(bounds.points.size() + dimensions);
    bounds.scale(example.parameters, std::span(bounds.points).last(dimensions));
  }
  return bounds;
}

Outside outside(const Bounds& bounds, std::span<const double> point) {
  const Index d = bounds.dimensions;
  const Eigen::Map<const MatrixXd> points(bounds.points.data(), d,
                                          static_cast<Index>(bounds.points.size()) / d);
  VectorXd scaled(d);
  bounds.scale(point, {scaled.data(), static_cast<std::size_t>(d)});
  Outside result;
  result.nearest.assign(point.begin(), point.end());
  VectorXd inside;
  if (scaled.allFinite() && scaled.cwiseAbs().maxCoeff() < 1e6) {
    const VectorXd way = nearest_to_origin(points.colwise() - scaled);
    const double distance = way.norm();
    if (distance <= bounds.margin + kRounding) return result;
    result.distance = distance - bounds.margin;
    inside = scaled + way * (result.distance / distance);
  } else {
    result.distance = std::numeric_limits<double>::infinity();
    inside = points.rowwise().mean();
  }
  for (Index i = 0; i < d; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double range = bounds.upper[k] - bounds.lower[k];
    result.nearest[k] = bounds.lower[k] + inside[i] * (range > kMinRange ? range : 1);
  }
  return result;
}

}  // namespace krok::parametric
