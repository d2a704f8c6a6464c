#include "rbf/weight_system_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numbers.h"
#include "math/dense_solve.h"
#include "rbf/weight_solver.h"

namespace krok::rbf::detail {

namespace {

constexpr double kRankTolerance = 1e-6;
constexpr double kMinPivot = 1e-13;      // relative to the diagonal
constexpr double kGoodResidual = 3e-13;  // no further refinement below it
constexpr int kMaxImprovements = 3;

}  // namespace

void bring_sums(std::span<double> rows, std::size_t columns, double first, double others) {
  for (std::size_t r = 0; r * columns < rows.size(); ++r) {
    const auto row = rows.subspan(r * columns, columns);
    const double sum = std::accumulate(row.begin(), row.end(), 0.0);
    const double more = ((r == 0 ? first : others) - sum) / static_cast<double>(columns);
    for (double& value : row) value += more;
  }
}

std::string place_text(std::span<const double> point) {
  std::string text;
  for (const double value : point) text += (text.empty() ? "" : ", ") + readable(value);
  return "(" + text + ")";
}

Result<std::unique_ptr<WeightSystem>> WeightSystem::start(WeightFunction function) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  const auto n = static_cast<std::size_t>(function.examples);
  Eigen::MatrixXd a(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(d + 1));
  std::vector<double> scaled(n * d);
  for (std::size_t k = 0; k < n; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const auto place = std::span(scaled).subspan(k * d, d);
    function.scale(function.centre(static_cast<int>(k)), place);
    a(row, 0) = 1;
    for (std::size_t i = 0; i < d; ++i) a(row, static_cast<Eigen::Index>(i) + 1) = place[i];
  }
  // Pivots on columns, which are the examples here.
  const PivotedColumns columns = pivoted_columns(a.transpose(), kRankTolerance);
  if (columns.rank < a.cols()) {
    return Error("rbf-rank",
                 fmt::format("the parameters of the {} examples vary in only {} directions, not "
                             "in all {}",
                             n, std::max<Eigen::Index>(columns.rank - 1, 0), d),
                 "leave out a parameter that depends on the others, or add examples");
  }
  std::vector<std::size_t> base;
  if (!has_radii(function.kernel)) {
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
      base.push_back(static_cast<std::size_t>(columns.order[static_cast<std::size_t>(i)]));
    }
    std::ranges::sort(base);
  }
  CentreMatrix matrix(function.kernel, d, function.smoothing, base, scaled);
  auto system = std::make_unique<WeightSystem>(
      WeightSystem{std::move(function), std::move(matrix), {}, {}, {}, {}, {}, 0});
  system->wanted.assign(n * n, 0.0);
  for (std::size_t k = 0; k < n; ++k) system->wanted[k * n + k] = 1;
  if (base.empty()) {
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> planes =
        solve_least_squares(a, Eigen::MatrixXd::Identity(a.rows(), a.rows()));
    system->plane.assign(planes.data(), planes.data() + planes.size());
    bring_sums(system->plane, n, 1, 0);
  }
  return system;
}

void WeightSystem::less_planes(std::span<const double> values, std::size_t k,
                               std::span<double> left) const {
  const auto row = values.subspan(k * n(), n());
  std::ranges::copy(row, left.begin());
  const auto take = [&](double factor, std::span<const double> from) {
    for (std::size_t j = 0; j < left.size(); ++j) left[j] -= factor * from[j];
  };
  if (!matrix.base().empty()) {
    for (std::size_t a = 0; a < matrix.base().size(); ++a) {
      take(matrix.planes(k)[a], values.subspan(matrix.base()[a] * n(), n()));
    }
  } else if (values.data() == wanted.data()) {
    for (std::size_t i = 0; i <= d(); ++i) {
      take(i == 0 ? 1 : matrix.place(k)[i - 1], std::span(plane).subspan(i * n(), n()));
    }
  }
}

Status WeightSystem::add_centre(std::span<const double> point, std::span<const double> row,
                                double radius) {
  double place_values[kMaxDimensions];
  const auto place = std::span(place_values).first(d());
  f.scale(point, place);
  const std::size_t k = matrix.size();
  matrix.append(place, radius);
  if (k >= n()) {
    wanted.insert(wanted.end(), row.begin(), row.end());
    f.centres.insert(f.centres.end(), point.begin(), point.end());
    f.inserted_rows.insert(f.inserted_rows.end(), row.begin(), row.end());
    if (has_radii(f.kernel)) f.radii.push_back(radius);
  }
  if (matrix.in_base(k)) return {};
  std::vector<double> in_row, in_column;
  for (const std::size_t i : others) {
    in_row.push_back(matrix.kappa(k, i));
    in_column.push_back(matrix.kappa(i, k));
  }
  const double corner = matrix.kappa(k, k);
  others.push_back(k);
  if (corner == 0 || !factors.append(in_row, in_column, corner, kMinPivot * std::abs(corner))) {
    return Error("rbf-conditioning",
                 fmt::format("the system is nearly singular at {}", place_text(point)),
                 "leave out points that are close together, or use another kernel");
  }
  forward.resize(others.size() * n());
  less_planes(wanted, k, std::span(forward).last(n()));
  factors.solve_lower(forward, n(), others.size() - 1);
  return {};
}

void WeightSystem::truncate(std::size_t centres) {
  matrix.truncate(centres);
  while (!others.empty() && others.back() >= centres) others.pop_back();
  factors.truncate(std::min(factors.size(), others.size()));
  wanted.resize(centres * n());
  forward.resize(others.size() * n());
  f.centres.resize(centres * d());
  f.inserted_rows.resize((centres - n()) * n());
  if (has_radii(f.kernel)) f.radii.resize(centres);
}

// Adds the solution for `values` at the centres to the function. `solved_below`: L^-1 of the values
// at the centres outside the base, minus the affine part.
void WeightSystem::add_solution(std::vector<double> solved_below, std::span<const double> values) {
  factors.solve_upper(solved_below, n());
  const std::size_t base = matrix.base().size();
  std::vector<double> more(matrix.size() * n());
  const auto row = [&](std::vector<double>& of, std::size_t k) {
    return std::span(of).subspan(k * n(), n());
  };
  for (std::size_t o = 0; o < others.size(); ++o) {
    const auto from = row(solved_below, o);
    std::ranges::copy(from, row(more, others[o]).begin());
    for (std::size_t a = 0; a < base; ++a) {
      const double factor = matrix.planes(others[o])[a];
      const auto to = row(more, matrix.base()[a]);
      for (std::size_t j = 0; j < n(); ++j) to[j] -= factor * from[j];
    }
  }
  // The affine part fits what the kernels leave over at the base.
  for (std::size_t a = 0; a < base; ++a) {
    std::vector<double> left(
        values.begin() + static_cast<std::ptrdiff_t>(matrix.base()[a] * n()),
        values.begin() + static_cast<std::ptrdiff_t>((matrix.base()[a] + 1) * n()));
    for (std::size_t k = 0; k < matrix.size(); ++k) {
      const double phi = matrix.phi(matrix.base()[a], k);
      const auto from = row(more, k);
      for (std::size_t j = 0; j < n(); ++j) left[j] -= phi * from[j];
    }
    for (std::size_t i = 0; i <= d(); ++i) {
      const double factor =
          matrix.base_inverse()(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(a));
      const auto to = row(f.affine, i);
      for (std::size_t j = 0; j < n(); ++j) to[j] += factor * left[j];
    }
  }
  for (std::size_t i = 0; i < more.size(); ++i) f.coefficients[i] += more[i];
  bring_sums(f.coefficients, n(), 0, 0);
  bring_sums(f.affine, n(), 1, 0);
}

// Residual of the targets at the centres; returns the largest.
double WeightSystem::find_residual(std::span<double> left) const {
  double largest = 0;
  for (std::size_t k = 0; k < matrix.size(); ++k) {
    const auto here = left.subspan(k * n(), n());
    std::copy_n(wanted.begin() + static_cast<std::ptrdiff_t>(k * n()), n(), here.begin());
    for (std::size_t i = 0; i <= d(); ++i) {
      const double factor = i == 0 ? 1 : matrix.place(k)[i - 1];
      for (std::size_t j = 0; j < n(); ++j) here[j] -= factor * f.affine[i * n() + j];
    }
    for (std::size_t c = 0; c < matrix.size(); ++c) {
      const double phi = matrix.phi(k, c);
      const double* from = f.coefficients.data() + c * n();
      for (std::size_t j = 0; j < n(); ++j) here[j] -= phi * from[j];
    }
    for (const double value : here) {
      // Also keeps NaN as the largest.
      if (!(std::abs(value) <= largest)) largest = std::abs(value);
    }
  }
  return largest;
}

Status WeightSystem::solve() {
  f.affine = matrix.base().empty() ? plane : std::vector<double>((d() + 1) * n());
  f.coefficients.assign(matrix.size() * n(), 0.0);
  add_solution(forward, wanted);
  std::vector<double> left(wanted.size()), before_affine, before_coefficients;
  residual = find_residual(left);
  for (int i = 0; i < kMaxImprovements && residual > kGoodResidual; ++i) {
    before_affine = f.affine;
    before_coefficients = f.coefficients;
    std::vector<double> below(others.size() * n());
    for (std::size_t o = 0; o < others.size(); ++o) {
      less_planes(left, others[o], std::span(below).subspan(o * n(), n()));
    }
    factors.solve_lower(below, n());
    add_solution(std::move(below), left);
    const double improved = find_residual(left);
    if (!(improved < residual)) {
      f.affine = std::move(before_affine);
      f.coefficients = std::move(before_coefficients);
      break;
    }
    const bool enough = improved > 0.5 * residual;
    residual = improved;
    if (enough) break;
  }
  if (residual <= WeightSolver::kResidual) return {};
  return Error("rbf-conditioning",
               fmt::format("the residual of the weights at the centres is {}", readable(residual)),
               "leave out points that are close together, or use another kernel");
}

double WeightSystem::condition() const {
  const std::size_t size = others.size();
  if (size == 0) return 1;
  double norm = 0;
  for (const std::size_t k : others) {
    double sum = 0;
    for (const std::size_t i : others) sum += std::abs(matrix.kappa(i, k));
    norm = std::max(norm, sum);
  }
  // Hager's ascent to the column of the inverse with the largest 1-norm.
  std::vector<double> x(size, 1 / static_cast<double>(size));
  double inverse_norm = 0;
  for (int i = 0; i < 5; ++i) {
    std::vector<double> y = x;
    factors.solve_lower(y, 1);
    factors.solve_upper(y, 1);
    double sum = 0;
    for (double& value : y) {
      sum += std::abs(value);
      value = value < 0 ? -1 : 1;
    }
    if (!(sum > inverse_norm)) break;
    inverse_norm = sum;
    factors.solve_transposed(y);
    const auto steepest =
        std::ranges::max_element(y, [](double a, double b) { return std::abs(a) < std::abs(b); });
    std::ranges::fill(x, 0.0);
    x[static_cast<std::size_t>(steepest - y.begin())] = 1;
  }
  return norm * inverse_norm;
}

// With targets u (minus the affine part through the base) at the other centres, the function is
// kappa(p, .) K^-1 u, where K is their kappa matrix. Inserted rows enter u unchanged.
void WeightSystem::influences(std::span<const double> point, std::span<double> of_rows) const {
  double place_values[kMaxDimensions];
  const auto place = std::span(place_values).first(d());
  f.scale(point, place);
  std::vector<double> values(others.size());
  matrix.kappa_at(place, others, values);
  factors.solve_transposed(values);
  const std::size_t examples = others.size() - of_rows.size();
  std::ranges::copy(std::span(values).subspan(examples), of_rows.begin());
}

bool all_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

}  // namespace krok::rbf::detail
