#include "fit/polish.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "fit/error_field_internal.h"
#include "fit/joint_rows_internal.h"
#include "rbf/sobol.h"
#include "rbf/weight_solver.h"

namespace krok::fit {

namespace {

using rbf::WeightEvaluator;
using rbf::WeightFunction;
using rbf::WeightSolver;

// Training points per row, and their min and max number: with fewer, errors between them grow.
constexpr int kPointsPerRow = 16;
constexpr int kMinPoints = 1024;
constexpr int kMaxPoints = 4096;
// Training points are drawn from a range that is larger by this on each side, per parameter beyond
// the first, and clamped: errors are largest at the boundary, whose share grows with dimension.
constexpr double kEdge = 0.015;
constexpr std::uint32_t kMaxTries = 1000;  // per accepted point
constexpr detail::JointTerms kTerms = {.stay = 0.003, .positive = 0.1, .low = 0, .iterations = 100};
constexpr double kParts[] = {1, 0.5, 0.25};  // of the full change
constexpr double kMaxRoughness = 1.1;        // relative to the unrefined function
// A weight that was too low before may be lower by this: far less than what refusing would cost.
constexpr double kSameWeight = 5e-4;
constexpr std::size_t kPolishGrain = 8;

// Weight functions with their metrics.
struct Candidate {
  WeightSolver solver;
  WeightEvaluator evaluator;
  RefineMetrics metrics;
  double lowest = 0;  // weight at held-out points
};

class Polisher {
 public:
  Polisher(const Refined& start, const rbf::Measure& measure, const RefineOptions& options)
      : start_(start),
        measure_(measure),
        options_(options),
        held_out_(start.function, measure, options),
        d_(static_cast<std::size_t>(start.function.dimensions)),
        n_(static_cast<std::size_t>(start.function.examples)) {}

  Result<Refined> run() const;

 private:
  Result<Candidate> candidate(const std::vector<double>& rows) const;
  std::vector<double> training_points() const;
  detail::JointRows about(const Candidate& found) const;
  bool is_better(const Candidate& polished, const Candidate& found) const;
  bool rows_stay_within(const std::vector<double>& rows) const;

  const Refined& start_;
  const rbf::Measure& measure_;
  const RefineOptions& options_;
  detail::HeldOut held_out_;
  std::size_t d_, n_;
};

Result<Candidate> Polisher::candidate(const std::vector<double>& rows) const {
  WeightFunction function = start_.function;
  function.inserted_rows = rows;
  auto solver = WeightSolver::resume(function);
  if (!solver) return solver.error();
  auto evaluator = WeightEvaluator::create(solver->function());
  if (!evaluator) return evaluator.error();
  Candidate made{*std::move(solver), *std::move(evaluator), {}, 0};
  made.metrics = held_out_.errors(made.solver.function(), made.evaluator);
  made.lowest = held_out_.lowest(made.solver.function(), made.evaluator);
  held_out_.add_rest(made.solver, made.evaluator, made.metrics);
  return made;
}

std::vector<double> Polisher::training_points() const {
  const int wanted = std::clamp(kPointsPerRow * start_.function.inserted(), kMinPoints, kMaxPoints);
  const rbf::Sobol sobol(start_.function.dimensions,
                         detail::seed_for(options_.seed, detail::Use::polish));
  const auto most = static_cast<std::size_t>(wanted) * d_;
  const double edge = kEdge * static_cast<double>(d_ - 1);
  std::vector<double> points, place(d_), point(d_);
  for (std::uint32_t p = 0; points.size() < most && p / kMaxTries < most / d_; ++p) {
    sobol.point(p, place);
    for (double& value : place) value = std::clamp(value * (1 + 2 * edge) - edge, 0.0, 1.0);
    detail::unscale(start_.function, place, point);
    if (options_.inside && !options_.inside(point)) continue;
    points.insert(points.end(), point.begin(), point.end());
  }
  return points;
}

// Points that cannot be measured have no effect.
detail::JointRows Polisher::about(const Candidate& found) const {
  const std::vector<double> points = training_points();
  detail::JointRows rows;
  rows.points = points.size() / d_;
  rows.dimensions = d_;
  rows.rows = static_cast<std::size_t>(start_.function.inserted());
  rows.examples = n_;
  rows.influences.resize(rows.points * rows.rows);
  rows.weights.resize(rows.points * n_);
  rows.errors.resize(rows.points * d_);
  rows.slopes.resize(rows.points * d_ * n_);
  parallel_for(rows.points, kPolishGrain, options_.jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const auto point = std::span(points).subspan(p * d_, d_);
      const auto weights = std::span(rows.weights).subspan(p * n_, n_);
      const auto errors = std::span(rows.errors).subspan(p * d_, d_);
      const auto slopes = std::span(rows.slopes).subspan(p * d_ * n_, d_ * n_);
      found.solver.influences(point, std::span(rows.influences).subspan(p * rows.rows, rows.rows));
      found.evaluator.weights(point, weights);
      const Status status = measure_(weights, errors, slopes);
      for (std::size_t a = 0; a < d_; ++a) {
        const double scale = found.evaluator.inverse_ranges()[a];
        errors[a] = (errors[a] - point[a]) * scale;
        for (double& slope : slopes.subspan(a * n_, n_)) slope *= scale;
      }
      const auto finite = [](double value) { return std::isfinite(value); };
      if (status.ok() && std::ranges::all_of(errors, finite) &&
          std::ranges::all_of(slopes, finite)) {
        continue;
      }
      std::ranges::fill(errors, 0.0);
      std::ranges::fill(slopes, 0.0);
    }
  });
  return rows;
}

bool Polisher::rows_stay_within(const std::vector<double>& rows) const {
  const auto [least, largest] = std::ranges::minmax(rows);
  const auto [least_found, largest_found] = std::ranges::minmax(start_.function.inserted_rows);
  return least >= std::min(options_.least, least_found) &&
         largest <= std::max(options_.largest, largest_found);
}

bool Polisher::is_better(const Candidate& polished, const Candidate& found) const {
  const RefineMetrics &now = polished.metrics, &was = found.metrics;
  if (!(now.mean_square < was.mean_square) || now.largest > was.largest ||
      now.failed > was.failed) {
    return false;
  }
  for (std::size_t a = 0; a < options_.tolerance.size(); ++a) {
    const double most = std::max(options_.tolerance[a], was.within[a].largest);
    if (now.within[a].largest > most) return false;
  }
  return std::min(polished.lowest, now.least_weight) >=
             std::min({options_.lowest, found.lowest - kSameWeight, was.least_weight}) &&
         now.roughness <= std::max(kMaxRoughness * start_.before.roughness, was.roughness);
}

Result<Refined> Polisher::run() const {
  const std::vector<double>& found_rows = start_.function.inserted_rows;
  const auto found = candidate(found_rows);
  if (!found) return found.error();
  detail::JointTerms terms = kTerms;
  terms.low = detail::low_limit(options_);
  const std::vector<double> changes = detail::joint_changes(about(*found), terms, options_.jobs);
  Refined result = start_;
  result.function = found->solver.function();
  for (const double part : kParts) {
    std::vector<double> rows = found_rows;
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] += part * changes[i];
    if (!rows_stay_within(rows)) continue;
    const auto polished = candidate(rows);
    if (!polished || !is_better(*polished, *found)) continue;
    result.function = polished->solver.function();
    result.polished = Polished{found_rows, polished->metrics};
    break;
  }
  return result;
}

}  // namespace

namespace detail {

Refined without_polish(Refined refined) {
  if (!refined.polished) return refined;
  refined.function.inserted_rows = std::move(refined.polished->found_rows);
  refined.polished.reset();
  return refined;
}

}  // namespace detail

Result<Refined> polish(const Refined& start, const rbf::Measure& measure,
                       const RefineOptions& options) {
  const Refined found = detail::without_polish(start);
  if (Status status = found.function.check(); !status) return status.error();
  const int inserted = found.function.inserted();
  if (inserted == 0 || inserted > kMaxPolished ||
      found.function.inserted_rows.size() > kMaxPolishedWeights) {
    return start;
  }
  return Polisher(found, measure, options).run();
}

}  // namespace krok::fit
