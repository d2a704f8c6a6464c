#include "fit/error_field_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/parallel.h"
#include "rbf/sobol.h"
#include "rbf/weight_function.h"

namespace krok::fit::detail {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kPointGrain = 8;  // points per task
constexpr int kClimbSteps = 12;
constexpr double kLastStride = 1.0 / 16;  // relative to the first
constexpr double kAround = 0.25;

// Reusable memory for evaluating points one at a time.
class Probe {
 public:
  Probe(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator,
        const rbf::Measure& measure)
      : function_(function),
        evaluator_(evaluator),
        measure_(measure),
        d_(static_cast<std::size_t>(function.dimensions)),
        n_(static_cast<std::size_t>(function.examples)),
        point_(d_),
        measured_(d_),
        weights_(n_),
        slopes_(d_ * n_),
        jacobian_(d_ * n_) {}

  // Error components at a place, scaled.
  Status error_at(std::span<const double> place, std::span<double> error) {
    unscale(function_, place, point_);
    evaluator_.weights(point_, weights_);
    if (Status status = measure_(weights_, measured_, {}); !status) return status;
    return take_error(error);
  }

  // Also the gradient of half the squared error.
  Status gradient_at(std::span<const double> place, std::span<double> error,
                     std::span<double> gradient) {
    unscale(function_, place, point_);
    evaluator_.slopes(point_, weights_, slopes_);
    if (Status status = measure_(weights_, measured_, jacobian_); !status) return status;
    if (Status status = take_error(error); !status) return status;
    for (std::size_t b = 0; b < d_; ++b) {
      gradient[b] = -error[b];
      for (std::size_t a = 0; a < d_; ++a) {
        double slope = 0;
        for (std::size_t j = 0; j < n_; ++j) slope += jacobian_[a * n_ + j] * slopes_[b * n_ + j];
        gradient[b] +=
            error[a] * slope * evaluator_.inverse_ranges()[a] / evaluator_.inverse_ranges()[b];
      }
    }
    return {};
  }

 private:
  Status take_error(std::span<double> error) const {
    for (std::size_t a = 0; a < d_; ++a) {
      error[a] = (measured_[a] - point_[a]) * evaluator_.inverse_ranges()[a];
      if (!std::isfinite(error[a])) return Error("fit-measure", "a parameter is NaN or infinite");
    }
    return {};
  }

  const rbf::WeightFunction& function_;
  const rbf::WeightEvaluator& evaluator_;
  const rbf::Measure& measure_;
  std::size_t d_, n_;
  std::vector<double> point_, measured_, weights_, slopes_, jacobian_;
};

double square_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return sum;
}

}  // namespace

std::vector<double> ErrorField::at(std::span<const double> places, Error* failure) const {
  const std::size_t d = dimensions(), count = places.size() / d;
  std::vector<double> errors(places.size());
  std::vector<Status> statuses(count);
  parallel_for(count, kPointGrain, jobs_, [&](std::size_t begin, std::size_t end) {
    Probe probe(function_, evaluator_, measure_);
    for (std::size_t p = begin; p < end; ++p) {
      const auto error = std::span(errors).subspan(p * d, d);
      statuses[p] = probe.error_at(places.subspan(p * d, d), error);
      if (!statuses[p]) std::ranges::fill(error, kNan);
    }
  });
  if (failure != nullptr) {
    const auto failed = std::ranges::find_if(statuses, [](const Status& s) { return !s.ok(); });
    if (failed != statuses.end()) *failure = failed->error();
  }
  return errors;
}

std::vector<double> ErrorField::climb(std::span<double> places, double stride) const {
  const std::size_t d = dimensions();
  std::vector<double> found(places.size() / d);
  parallel_for(found.size(), 1, jobs_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      found[p] = climb_from(places.subspan(p * d, d), stride);
    }
  });
  return found;
}

double ErrorField::climb_from(std::span<double> place, double stride) const {
  const std::size_t d = dimensions();
  Probe probe(function_, evaluator_, measure_);
  std::vector<double> error(d), gradient(d), next(d), point(d), next_error(d), next_gradient(d);
  if (!probe.gradient_at(place, error, gradient)) return 0;
  double square = square_of(error);
  double length = stride;
  for (int step = 0; step < kClimbSteps && length > kLastStride * stride; ++step) {
    const double steepness = std::sqrt(square_of(gradient));
    if (!(steepness > 0)) break;
    for (std::size_t i = 0; i < d; ++i) {
      next[i] = std::clamp(place[i] + length / steepness * gradient[i], 0.0, 1.0);
    }
    unscale(function_, next, point);
    const bool higher = (!inside_ || inside_(point)) &&
                        probe.gradient_at(next, next_error, next_gradient).ok() &&
                        square_of(next_error) > square;
    if (!higher) {
      length *= 0.5;
      continue;
    }
    std::ranges::copy(next, place.begin());
    gradient.swap(next_gradient);
    square = square_of(next_error);
  }
  return std::sqrt(square);
}

std::vector<double> ErrorField::lengths(std::span<const double> errors) const {
  const std::size_t d = dimensions();
  std::vector<double> result;
  for (std::size_t p = 0; p < errors.size(); p += d) {
    const double length = std::sqrt(square_of(errors.subspan(p, d)));
    result.push_back(std::isfinite(length) ? length : 0);
  }
  return result;
}

std::vector<ParameterError> ErrorField::by_parameter(std::span<const double> errors) const {
  const std::size_t d = dimensions();
  std::vector<ParameterError> result(d);
  for (std::size_t a = 0; a < d; ++a) {
    std::vector<double> sizes;
    double sum = 0;
    for (std::size_t p = a; p < errors.size(); p += d) {
      if (!std::isfinite(errors[p])) continue;
      sizes.push_back(std::abs(errors[p]) * (function_.upper[a] - function_.lower[a]));
      sum += sizes.back();
    }
    if (sizes.empty()) continue;
    std::ranges::sort(sizes);
    result[a].largest = sizes.back();
    result[a].mean = sum / static_cast<double>(sizes.size());
    result[a].most = sizes[(sizes.size() * 95 + 99) / 100 - 1];
  }
  return result;
}

std::vector<double> places_within(const rbf::WeightFunction& function, int count,
                                  std::uint64_t seed, const rbf::Inside& inside) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  const std::vector<double> points = rbf::points_inside(function, count, seed, inside);
  std::vector<double> places(points.size());
  for (std::size_t p = 0; p < points.size(); p += d) {
    function.scale(std::span(points).subspan(p, d), std::span(places).subspan(p, d));
  }
  return places;
}

std::vector<double> places_around(const rbf::WeightFunction& function, int count,
                                  std::uint64_t seed, const rbf::Inside& inside) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  const rbf::Sobol sobol(function.dimensions, seed);
  std::vector<double> places, place(d), point(d);
  for (std::uint32_t p = 0; places.size() < static_cast<std::size_t>(count) * d; ++p) {
    sobol.point(p, place);
    bool within = true;
    for (double& value : place) {
      value = value * (1 + 2 * kAround) - kAround;
      within = within && value >= 0 && value <= 1;
    }
    unscale(function, place, point);
    if (within && (!inside || inside(point))) continue;
    places.insert(places.end(), place.begin(), place.end());
  }
  return places;
}

void unscale(const rbf::WeightFunction& function, std::span<const double> place,
             std::span<double> point) {
  for (std::size_t i = 0; i < place.size(); ++i) {
    point[i] = function.lower[i] + place[i] * (function.upper[i] - function.lower[i]);
  }
}

namespace {

constexpr int kHeldOutPerParameter = 256;  // per parameter
constexpr int kMaxPoints = 1024;
constexpr int kOutsidePoints = 256;
constexpr int kMetricPoints = 128;  // for range and roughness of the weights

}  // namespace

std::uint64_t seed_for(std::uint64_t seed, Use use, std::size_t round) {
  return (seed * 1000003 + round) * 3 + static_cast<std::uint64_t>(use) + 1;
}

HeldOut::HeldOut(const rbf::WeightFunction& function, const rbf::Measure& measure,
                 const RefineOptions& options)
    : measure_(measure),
      options_(options),
      d_(static_cast<std::size_t>(function.dimensions)),
      within_(places_within(function,
                            options.held_out > 0
                                ? options.held_out
                                : std::min(kHeldOutPerParameter * function.dimensions, kMaxPoints),
                            seed_for(options.seed, Use::held_out), options.inside)),
      outside_(places_around(function, kOutsidePoints, seed_for(options.seed, Use::outside),
                             options.inside)) {}

RefineMetrics HeldOut::errors(const rbf::WeightFunction& function,
                              const rbf::WeightEvaluator& evaluator, Error* failure) const {
  RefineMetrics result;
  const ErrorField field(function, evaluator, measure_, options_.inside, options_.jobs);
  const std::vector<double> within = field.at(within_, failure);
  result.within = field.by_parameter(within);
  for (std::size_t p = 0; p < count(); ++p) result.failed += std::isnan(within[p * d_]) ? 1 : 0;
  for (const double length : field.lengths(within)) {
    result.largest = std::max(result.largest, length);
    result.mean_square += length * length;
  }
  const auto measured = static_cast<int>(count()) - result.failed;
  if (measured > 0) result.mean_square /= measured;
  return result;
}

double HeldOut::lowest(const rbf::WeightFunction& function,
                       const rbf::WeightEvaluator& evaluator) const {
  return lowest_weight(function, evaluator, within_);
}

void HeldOut::add_rest(const rbf::WeightSolver& solver, const rbf::WeightEvaluator& evaluator,
                       RefineMetrics& metrics) const {
  const ErrorField field(solver.function(), evaluator, measure_, options_.inside, options_.jobs);
  metrics.outside = field.by_parameter(field.at(outside_));
  if (const auto weights = rbf::weight_metrics(solver.function(), kMetricPoints, options_.inside)) {
    metrics.least_weight = weights->least;
    metrics.largest_weight = weights->largest;
    metrics.roughness = weights->roughness;
  }
  metrics.condition = solver.condition();
}

namespace {

constexpr std::size_t kMinStarts = 8;  // of climbs

double distance(std::span<const double> a, std::span<const double> b) {
  double square = 0;
  for (std::size_t i = 0; i < a.size(); ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(square);
}

}  // namespace

bool is_apart(std::span<const double> place, std::span<const ErrorPoint> others, double least) {
  return std::ranges::all_of(
      others, [&](const ErrorPoint& other) { return distance(place, other.place) >= least; });
}

double usual_distance(const rbf::WeightFunction& function) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  const auto count = static_cast<std::size_t>(function.centre_count());
  std::vector<double> places(count * d);
  for (std::size_t k = 0; k < count; ++k) {
    function.scale(function.centre(static_cast<int>(k)), std::span(places).subspan(k * d, d));
  }
  std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < k; ++i) {
      const double apart =
          distance(std::span(places).subspan(k * d, d), std::span(places).subspan(i * d, d));
      nearest[k] = std::min(nearest[k], apart);
      nearest[i] = std::min(nearest[i], apart);
    }
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::ranges::nth_element(nearest, middle);
  return *middle;
}

std::vector<ErrorPoint> worst_points(const ErrorField& field, std::span<const double> sweep,
                                     const std::vector<ErrorPoint>& avoided, std::size_t wanted,
                                     double usual, double avoid, double& worst) {
  const std::size_t d = field.dimensions();
  const std::vector<double> lengths = field.lengths(field.at(sweep));
  std::vector<std::size_t> order(lengths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return lengths[a] > lengths[b]; });
  worst = order.empty() ? 0 : lengths[order.front()];

  std::vector<ErrorPoint> starts;
  std::vector<double> climbing;
  for (const std::size_t p : order) {
    if (starts.size() >= std::max(2 * wanted, kMinStarts) || !(lengths[p] > kNegligible)) break;
    const auto place = sweep.subspan(p * d, d);
    if (!is_apart(place, starts, kApart * usual) || !is_apart(place, avoided, avoid)) {
      continue;
    }
    starts.push_back({{place.begin(), place.end()}, lengths[p]});
    climbing.insert(climbing.end(), place.begin(), place.end());
  }
  const std::vector<double> heights = field.climb(climbing, kApart * usual);
  // If a climb ends near an avoided point, its start may still be usable.
  for (std::size_t s = 0; s < starts.size(); ++s) {
    const auto top = std::span(climbing).subspan(s * d, d);
    if (!is_apart(top, avoided, avoid)) continue;
    starts[s] = {{top.begin(), top.end()}, heights[s]};
  }
  std::ranges::stable_sort(
      starts, [](const ErrorPoint& a, const ErrorPoint& b) { return a.error > b.error; });
  std::vector<ErrorPoint> found;
  for (ErrorPoint& start : starts) {
    if (found.size() == wanted) break;
    if (is_apart(start.place, found, kApart * usual)) found.push_back(std::move(start));
  }
  return found;
}

namespace {

// The lowest weight at each place.
std::vector<double> lowest_at(const rbf::WeightFunction& function,
                              const rbf::WeightEvaluator& evaluator,
                              std::span<const double> places) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  std::vector<double> point(d), weights(static_cast<std::size_t>(function.examples)), lowest;
  for (std::size_t p = 0; p < places.size(); p += d) {
    unscale(function, places.subspan(p, d), point);
    evaluator.weights(point, weights);
    lowest.push_back(std::ranges::min(weights));
  }
  return lowest;
}

}  // namespace

double lowest_weight(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator,
                     std::span<const double> places) {
  const std::vector<double> lowest = lowest_at(function, evaluator, places);
  return lowest.empty() ? 0 : std::ranges::min(lowest);
}

std::vector<std::vector<double>> low_places(const rbf::WeightFunction& function,
                                            const rbf::WeightEvaluator& evaluator,
                                            std::span<const double> places,
                                            const std::vector<ErrorPoint>& avoided,
                                            std::size_t wanted, double limit, double usual) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  const std::vector<double> lowest = lowest_at(function, evaluator, places);
  std::vector<std::size_t> order(lowest.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t p) { return lowest[p]; });
  std::vector<std::vector<double>> found;
  std::vector<ErrorPoint> taken;
  for (const std::size_t p : order) {
    if (found.size() == wanted || !(lowest[p] < limit)) break;
    const auto place = places.subspan(p * d, d);
    if (!is_apart(place, taken, kApart * usual) || !is_apart(place, avoided, kNear * usual)) {
      continue;
    }
    found.emplace_back(place.begin(), place.end());
    taken.push_back({found.back(), 0});
  }
  return found;
}

}  // namespace krok::fit::detail
