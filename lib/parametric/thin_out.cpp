#include "parametric/thin_out.h"

#include <Eigen/Core>
#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <string_view>

#include "parametric/bounds.h"

namespace krok::parametric {

namespace {

constexpr double kSame = 1e-3;  // of the ranges

// Farthest-point sampling among the columns of `points` that `from` names.
std::vector<int> farthest(const Eigen::MatrixXd& points, const std::vector<int>& from,
                          double spacing, std::size_t most) {
  std::vector<int> kept;
  const Eigen::MatrixXd some = points(Eigen::all, from);
  // Distance to the nearest kept example.
  Eigen::VectorXd distances =
      Eigen::VectorXd::Constant(some.cols(), std::numeric_limits<double>::infinity());
  Eigen::Index next = 0;
  const Eigen::VectorXd middle = some.rowwise().mean();
  (some.colwise() - middle).colwise().squaredNorm().minCoeff(&next);
  do {
    kept.push_back(from[static_cast<std::size_t>(next)]);
    const Eigen::VectorXd chosen = some.col(next);
    distances = distances.cwiseMin((some.colwise() - chosen).colwise().norm().transpose());
  } while (kept.size() < most && distances.maxCoeff(&next) >= spacing);
  std::ranges::sort(kept);
  return kept;
}

// [d x examples], scaled by the ranges.
Eigen::MatrixXd points_of(const Library& library) {
  const Bounds bounds = bounds_of(library);
  return Eigen::Map<const Eigen::MatrixXd>(bounds.points.data(), bounds.dimensions,
                                           static_cast<Eigen::Index>(library.examples.size()));
}

// So many of one style.
void add_share(const Eigen::MatrixXd& points, const std::vector<int>& style, std::size_t share,
               std::vector<int>& chosen) {
  if (style.size() <= share) {
    chosen.insert(chosen.end(), style.begin(), style.end());
    return;
  }
  const std::vector<int> ends = farthest(points, style, 0, std::max<std::size_t>(share / 2, 1));
  std::vector<int> rest;
  std::ranges::set_difference(style, ends, std::back_inserter(rest));
  chosen.insert(chosen.end(), ends.begin(), ends.end());
  for (std::size_t i = ends.size(); i < share; ++i) {
    chosen.push_back(rest[(i - ends.size()) * rest.size() / (share - ends.size())]);
  }
}

}  // namespace

std::vector<int> thin_out(const Library& library, double spacing, std::size_t most) {
  std::vector<int> all(library.examples.size());
  std::iota(all.begin(), all.end(), 0);
  if (all.empty() || !(spacing > 0)) return all;
  return farthest(points_of(library), all, spacing, most);
}

std::vector<int> thin_out_smoothed(const Library& library) {
  std::map<std::string_view, std::vector<int>> by_name;
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    by_name[library.examples[i].style].push_back(static_cast<int>(i));
  }
  if (by_name.empty()) return {};
  std::vector<std::vector<int>> styles;
  for (auto& [name, style] : by_name) styles.push_back(std::move(style));
  std::ranges::stable_sort(styles, {}, &std::vector<int>::size);
  const Eigen::MatrixXd points = points_of(library);
  std::vector<int> chosen;
  for (std::size_t s = 0; s < styles.size(); ++s) {
    const std::size_t left = kMaxSmoothed - std::min(chosen.size(), kMaxSmoothed);
    add_share(points, styles[s], left / (styles.size() - s), chosen);
  }
  std::ranges::sort(chosen);
  return chosen.empty() ? chosen : farthest(points, chosen, kSame, chosen.size());
}

}  // namespace krok::parametric
