#include "parametric/thin_out.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>

#include "parametric/bounds.h"

namespace krok::parametric {

std::vector<int> thin_out(const Library& library, double spacing, std::size_t most) {
  const auto n = static_cast<Eigen::Index>(library.examples.size());
  std::vector<int> kept(library.examples.size());
  std::iota(kept.begin(), kept.end(), 0);
  if (n == 0 || !(spacing > 0)) return kept;
  kept.clear();
  const Bounds bounds = bounds_of(library);
  const Eigen::Map<const Eigen::MatrixXd> points(bounds.points.data(), bounds.dimensions, n);
  // Distance to the nearest kept example.
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  Eigen::Index next = 0;
  const Eigen::VectorXd middle = points.rowwise().mean();
  (points.colwise() - middle).colwise().squaredNorm().minCoeff(&next);
  do {
    kept.push_back(static_cast<int>(next));
    const Eigen::VectorXd chosen = points.col(next);
    distances = distances.cwiseMin((points.colwise() - chosen).colwise().norm().transpose());
  } while (kept.size() < most && distances.maxCoeff(&next) >= spacing);
  std::ranges::sort(kept);
  return kept;
}

}  // namespace krok::parametric
