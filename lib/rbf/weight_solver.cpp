#include "rbf/weight_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/numbers.h"
#include "rbf/weight_system_internal.h"

namespace krok::rbf {

namespace {

constexpr double kRowSumTolerance = 1e-6;  // of given rows

// Distance from each example to the nearest other one, scaled. Code: rbf-duplicate.
Result<std::vector<double>> example_distances(const WeightFunction& f) {
  const auto n = static_cast<std::size_t>(f.examples);
  const auto d = static_cast<std::size_t>(f.dimensions);
  std::vector<double> scaled(n * d);
  for (std::size_t k = 0; k < n; ++k) {
    f.scale(f.centre(static_cast<int>(k)), std::span(scaled).subspan(k * d, d));
  }
  std::vector<double> nearest(n, std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < k; ++i) {
      double square = 0;
      for (std::size_t a = 0; a < d; ++a) {
        const double along = scaled[k * d + a] - scaled[i * d + a];
        square += along * along;
      }
      const double distance = std::sqrt(square);
      if (!(distance >= detail::kMinDistance)) {
        return Error("rbf-duplicate",
                     fmt::format("examples {} and {} have the same parameters, {}", i + 1, k + 1,
                                 detail::place_text(f.centre(static_cast<int>(k)))),
                     "leave out one of them, or add a parameter that distinguishes them");
      }
      nearest[k] = std::min(nearest[k], distance);
      nearest[i] = std::min(nearest[i], distance);
    }
  }
  return nearest;
}

}  // namespace

Result<WeightSolver> WeightSolver::create(int dimensions, std::span<const double> parameters,
                                          const SolverOptions& options) {
  WeightFunction f;
  f.kernel = options.kernel;
  f.dimensions = dimensions;
  f.smoothing = options.smoothing;
  if (dimensions >= 1 && dimensions <= kMaxDimensions) {
    f.examples = static_cast<int>(std::min<std::size_t>(
        parameters.size() / static_cast<std::size_t>(dimensions), kMaxCentres));
  }
  f.centres.assign(parameters.begin(), parameters.end());
  f.lower = options.lower;
  f.upper = options.upper;
  const auto d = static_cast<std::size_t>(f.dimensions);
  const auto n = static_cast<std::size_t>(f.examples);
  if (f.lower.empty() && f.upper.empty() && n > 0) {
    f.lower.assign(d, std::numeric_limits<double>::infinity());
    f.upper.assign(d, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < n * d; ++i) {
      f.lower[i % d] = std::min(f.lower[i % d], parameters[i]);
      f.upper[i % d] = std::max(f.upper[i % d], parameters[i]);
    }
  }
  // check() must pass before the radii and coefficients are known.
  WeightFunction shape = f;
  if (has_radii(f.kernel)) shape.radii.assign(n, 1.0);
  shape.affine.assign((d + 1) * n, 0.0);
  std::fill_n(shape.affine.begin(), n, n > 0 ? 1 / static_cast<double>(n) : 0.0);
  shape.coefficients.assign(n * n, 0.0);
  if (Status status = shape.check(); !status) return status.error();
  return from_function(std::move(f));
}

Result<WeightSolver> WeightSolver::resume(const WeightFunction& function) {
  if (Status status = function.check(); !status) return status.error();
  return from_function(function);
}

// Adds all examples, then all inserted points. Computes the examples' radii if missing.
Result<WeightSolver> WeightSolver::from_function(WeightFunction function) {
  const std::vector<double> centres = function.centres;
  const std::vector<double> rows = std::move(function.inserted_rows);
  std::vector<double> radii = std::move(function.radii);
  const auto d = static_cast<std::size_t>(function.dimensions);
  const auto n = static_cast<std::size_t>(function.examples);
  function.centres.resize(n * d);
  function.inserted_rows.clear();
  auto distances = example_distances(function);
  if (!distances) return distances.error();
  if (has_radii(function.kernel)) {
    if (radii.empty()) {
      for (const double distance : *distances) {
        radii.push_back(detail::radius_factor(function.kernel) * distance);
      }
    }
    function.radii.assign(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(n));
  }
  auto system = detail::WeightSystem::start(std::move(function));
  if (!system) return system.error();
  WeightSolver solver(std::move(*system));
  for (std::size_t k = 0; k < centres.size() / d; ++k) {
    const auto point = std::span(centres).subspan(k * d, d);
    const auto row = k < n ? std::span<const double>() : std::span(rows).subspan((k - n) * n, n);
    const double radius = radii.empty() ? 1 : radii[k];
    if (Status status = solver.system_->add_centre(point, row, radius); !status) {
      return status.error();
    }
  }
  if (Status status = solver.system_->solve(); !status) return status.error();
  return solver;
}

Status WeightSolver::insert(std::span<const double> points, std::span<const double> rows) {
  detail::WeightSystem& system = *system_;
  const std::size_t before = system.matrix.size();
  const std::size_t count = points.size() / system.d();
  if (before + count > kMaxCentres) {
    return Error("rbf-centres", fmt::format("too many centres: {}", before + count),
                 fmt::format("the max is {}", kMaxCentres));
  }
  std::vector<double> affine = system.f.affine, coefficients = system.f.coefficients;
  const double residual = system.residual;
  Status status;
  for (std::size_t p = 0; p < count && status.ok(); ++p) {
    const auto point = points.subspan(p * system.d(), system.d());
    const auto given = rows.subspan(p * system.n(), system.n());
    if (status = check_insertion(point, given); !status) break;
    std::vector<double> row(given.begin(), given.end());
    detail::bring_sums(row, system.n(), 1, 1);
    const double radius = detail::radius_factor(system.f.kernel) * distance_to_centres(point);
    status = system.add_centre(point, row, radius);
  }
  if (status.ok()) status = system.solve();
  if (!status) {
    system.truncate(before);
    system.f.affine = std::move(affine);
    system.f.coefficients = std::move(coefficients);
    system.residual = residual;
  }
  return status;
}

double WeightSolver::distance_to_centres(std::span<const double> point) const {
  double place_values[kMaxDimensions];
  const auto place = std::span(place_values).first(system_->d());
  system_->f.scale(point, place);
  return system_->matrix.nearest(place);
}

Status WeightSolver::check_insertion(std::span<const double> point,
                                     std::span<const double> row) const {
  if (!detail::all_finite(point) || !detail::all_finite(row)) {
    return Error("rbf-number", "an inserted point or its weights contain NaN or infinity");
  }
  const double sum = std::accumulate(row.begin(), row.end(), 0.0);
  if (!(std::abs(sum - 1) <= kRowSumTolerance)) {
    return Error("rbf-sum", fmt::format("the weights given at {} sum to {}, not to 1",
                                        detail::place_text(point), readable(sum)));
  }
  if (!(distance_to_centres(point) >= detail::kMinDistance)) {
    return Error("rbf-duplicate",
                 fmt::format("there is already a centre at {}", detail::place_text(point)),
                 "centres must differ by at least a millionth of the ranges");
  }
  return {};
}

void WeightSolver::remove_last(int points) {
  const int removed = std::clamp(points, 0, system_->f.inserted());
  if (removed == 0) return;
  system_->truncate(system_->matrix.size() - static_cast<std::size_t>(removed));
  // These centres were solved before, so it cannot fail.
  (void)system_->solve().ok();
}

const WeightFunction& WeightSolver::function() const {
  return system_->f;
}

void WeightSolver::influences(std::span<const double> point, std::span<double> of_rows) const {
  system_->influences(point, of_rows);
}

double WeightSolver::residual() const {
  return system_->residual;
}

double WeightSolver::condition() const {
  return system_->condition();
}

WeightSolver::WeightSolver(std::unique_ptr<detail::WeightSystem> system)
    : system_(std::move(system)) {}
WeightSolver::WeightSolver(const WeightSolver& other)
    : system_(std::make_unique<detail::WeightSystem>(*other.system_)) {}
WeightSolver::WeightSolver(WeightSolver&& other) noexcept = default;
WeightSolver& WeightSolver::operator=(const WeightSolver& other) {
  if (this != &other) system_ = std::make_unique<detail::WeightSystem>(*other.system_);
  return *this;
}
WeightSolver& WeightSolver::operator=(WeightSolver&& other) noexcept = default;
WeightSolver::~WeightSolver() = default;

}  // namespace krok::rbf
