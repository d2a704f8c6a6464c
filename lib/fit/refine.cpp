#include "fit/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/parallel.h"
#include "fit/error_field_internal.h"
#include "fit/joint_rows_internal.h"
#include "rbf/weight_solver.h"

namespace krok::fit {

namespace {

using rbf::WeightEvaluator;
using rbf::WeightSolver;

constexpr int kPointsPerParameter = 40;  // per parameter
constexpr double kGrowth = 1.25;  // max mean square held-out error, relative to its min so far
constexpr int kStalledRounds = 10;
constexpr double kLowerOnTheWay = 0.02;
constexpr int kRefusedRounds = 2;  // rounds before a refused point may be tried again
// Distance of new points to refused ones, in usual distances; grows with each round in vain after
// the first ones.
constexpr int kPatience = 2;
constexpr double kAvoid = detail::kNear, kMaxAvoid = 4 * detail::kNear;

using detail::Found;

class Refiner {
 public:
  Refiner(Refined state, WeightSolver solver, const rbf::Measure& measure,
          const RefineOptions& options)
      : state_(std::move(state)),
        solver_(std::move(solver)),
        measure_(measure),
        options_(options),
        d_(static_cast<std::size_t>(solver_.function().dimensions)),
        n_(static_cast<std::size_t>(solver_.function().examples)),
        held_out_(solver_.function(), measure, options) {}

  Status begin();
  Status find_lowest_at_first();
  Status run(Progress& progress);
  Refined take() && { return std::move(state_); }

 private:
  std::optional<Stop> stop(std::size_t rounds_before) const;
  bool is_good() const;
  int points_left() const;
  Status update();
  detail::ErrorField field() const {
    return {solver_.function(), *evaluator_, measure_, options_.inside, options_.jobs};
  }
  double limit() const { return detail::low_limit(options_); }
  // Rounds since the last one that inserted a point.
  int rounds_in_vain() const;
  std::vector<Found> seek(double usual, double& worst) const;
  // Returns false if no error is left.
  Result<bool> make_round();
  Status insert(std::vector<Found>& found, RefineRound& round);
  bool has_grown(const RefineMetrics& now) const;
  double lowest_allowed(double before) const;
  void refuse(const Found& found, RefineRound& round);

  Refined state_;
  WeightSolver solver_;
  std::optional<WeightEvaluator> evaluator_;
  const rbf::Measure& measure_;
  const RefineOptions& options_;
  std::size_t d_, n_;
  detail::HeldOut held_out_;
  RefineMetrics now_;
  double lowest_ = 0;           // weight at held-out points
  double lowest_at_first_ = 0;  // the same before the first round
};

// Call after each change of the functions.
Status Refiner::update() {
  auto evaluator = WeightEvaluator::create(solver_.function());
  if (!evaluator) return evaluator.error();
  evaluator_ = std::move(*evaluator);
  lowest_ = held_out_.lowest(solver_.function(), *evaluator_);
  return {};
}

// From the function without the points of earlier rounds, so that continuing changes nothing. The
// least weight in the metrics will not do: it is taken at fewer points, and with four parameters
// often misses the lowest ones, so that every insertion seemed to lower the weights.
Status Refiner::find_lowest_at_first() {
  int inserted = 0;
  for (const RefineRound& round : state_.rounds) inserted += round.inserted;
  if (inserted == 0) {
    lowest_at_first_ = lowest_;
    return {};
  }
  WeightSolver start = solver_;
  start.remove_last(inserted);
  const auto evaluator = WeightEvaluator::create(start.function());
  if (!evaluator) return evaluator.error();
  lowest_at_first_ = held_out_.lowest(start.function(), *evaluator);
  return {};
}

Status Refiner::begin() {
  if (Status status = update(); !status) return status;
  if (Status status = find_lowest_at_first(); !status) return status;
  std::vector<double> places(n_ * d_);
  for (std::size_t k = 0; k < n_; ++k) {
    solver_.function().scale(solver_.function().centre(static_cast<int>(k)),
                             std::span(places).subspan(k * d_, d_));
  }
  Error failure;
  const std::vector<double> at_examples = field().at(places, &failure);
  const auto wrong = std::ranges::find_if(at_examples, [](double e) { return std::isnan(e); });
  if (wrong != at_examples.end()) {
    failure.message = fmt::format("example {} cannot be measured: {}",
                                  static_cast<std::size_t>(wrong - at_examples.begin()) / d_ + 1,
                                  failure.message);
    failure.code = "fit-measure";
    return failure;
  }
  if (state_.rounds.empty()) {
    state_.example_error = std::ranges::max(field().lengths(at_examples));
  }
  if (held_out_.count() == 0) {
    return Error("fit-inside", "no point of the parameters' range is inside the allowed region");
  }
  now_ = held_out_.errors(solver_.function(), *evaluator_, &failure);
  if (now_.failed > static_cast<int>(held_out_.count() / 2)) {
    failure.message = fmt::format("{} of {} points within the range cannot be measured: {}",
                                  now_.failed, held_out_.count(), failure.message);
    failure.code = "fit-measure";
    return failure;
  }
  held_out_.add_rest(solver_, *evaluator_, now_);
  if (state_.rounds.empty()) state_.before = now_;
  return {};
}

int Refiner::points_left() const {
  const int most =
      options_.points > 0 ? options_.points : kPointsPerParameter * static_cast<int>(d_);
  return most - solver_.function().inserted();
}

// Whether all errors are within the targets.
bool Refiner::is_good() const {
  if (options_.tolerance.empty() || now_.failed > 0) return false;
  for (std::size_t a = 0; a < d_; ++a) {
    const double range = solver_.function().upper[a] - solver_.function().lower[a];
    const double error = now_.within[a].largest;
    const bool gained = error * options_.gain <= state_.before.within[a].largest ||
                        error <= detail::kNegligible * range;
    if (error > options_.tolerance[a] || !gained) return false;
  }
  return true;
}

std::optional<Stop> Refiner::stop(std::size_t rounds_before) const {
  const auto& rounds = state_.rounds;
  // Weights that are too low do not prevent stopping once no round improves them.
  const bool low = lowest_ < limit() && (rounds.empty() || rounds.back().inserted > 0);
  if (is_good() && !low) return Stop::tolerance;
  if (points_left() <= 0) return Stop::points;
  if (rounds_in_vain() >= kStalledRounds) return Stop::stalled;
  if (options_.rounds > 0 &&
      rounds.size() - rounds_before >= static_cast<std::size_t>(options_.rounds)) {
    return Stop::rounds;
  }
  return {};
}

Status Refiner::run(Progress& progress) {
  const std::size_t rounds_before = state_.rounds.size();
  progress.begin("refining", static_cast<std::uint64_t>(std::max(points_left(), 0)));
  for (;;) {
    if (const auto why = stop(rounds_before)) {
      state_.stop = *why;
      break;
    }
    const auto made = make_round();
    if (!made) return made.error();
    if (!*made) {
      state_.stop = Stop::exact;
      break;
    }
    progress.advance(static_cast<std::uint64_t>(state_.rounds.back().inserted));
  }
  progress.end();
  state_.function = solver_.function();
  return {};
}

int Refiner::rounds_in_vain() const {
  const auto& rounds = state_.rounds;
  const auto last = std::find_if(rounds.rbegin(), rounds.rend(),
                                 [](const RefineRound& round) { return round.inserted > 0; });
  return static_cast<int>(last - rounds.rbegin());
}

// The points with the largest errors, worst first, at most as many as a round takes. `worst`:
// receives the largest error of the sweep.
std::vector<Found> Refiner::seek(double usual, double& worst) const {
  const int sweep = options_.sweep > 0 ? options_.sweep : 128 * static_cast<int>(d_);
  const std::vector<double> sweep_places = detail::places_within(
      solver_.function(), sweep,
      detail::seed_for(options_.seed, detail::Use::sweep, state_.rounds.size()), options_.inside);
  // Where points are refused round after round, the search goes on elsewhere.
  const int in_vain = rounds_in_vain();
  const int kept = std::max(kRefusedRounds, in_vain);
  const double avoid = std::min(kAvoid * (1 + std::max(0, in_vain - kPatience)), kMaxAvoid) * usual;
  std::vector<detail::ErrorPoint> avoided;
  for (const RefusedPoint& refused : state_.refused) {
    if (refused.round + kept < static_cast<int>(state_.rounds.size())) continue;
    avoided.push_back({std::vector<double>(d_), 0});
    solver_.function().scale(refused.point, avoided.back().place);
  }
  const auto wanted = static_cast<std::size_t>(std::min(options_.points_a_round, points_left()));
  std::vector<Found> found;
  const auto take = [&](std::vector<double> place, double error, bool low) {
    found.push_back({});
    found.back().point.resize(d_);
    detail::unscale(solver_.function(), place, found.back().point);
    found.back().place = std::move(place);
    found.back().sought = error;
    found.back().low = low;
  };
  // If low weights cannot be raised, every other round is for errors alone.
  const bool low_too = in_vain < kPatience || in_vain % 2 == 0;
  const std::size_t low_wanted = low_too ? (wanted + 1) / 2 : 0;
  for (std::vector<double>& place : detail::low_places(
           solver_.function(), *evaluator_, sweep_places, avoided, low_wanted, limit(), usual)) {
    avoided.push_back({place, 0});
    take(std::move(place), field().lengths(field().at(avoided.back().place)).front(), true);
  }
  for (detail::ErrorPoint& top : detail::worst_points(field(), sweep_places, avoided,
                                                      wanted - found.size(), usual, avoid, worst)) {
    if (!is_good()) take(std::move(top.place), top.error, false);
  }
  return found;
}

bool Refiner::has_grown(const RefineMetrics& now) const {
  double least = std::min(state_.before.mean_square, now_.mean_square);
  for (const RefineRound& round : state_.rounds) {
    least = std::min(least, round.after.mean_square);
  }
  return now.failed > now_.failed || !(now.mean_square <= kGrowth * least);
}

// Weights that satisfy `lowest` must keep doing so. If some do not yet, they may temporarily fall
// slightly below their initial values: those in the metrics, or, if nothing could be inserted with
// these in the first rounds, those at the held-out points.
double Refiner::lowest_allowed(double before) const {
  if (before >= options_.lowest) return options_.lowest;
  const double allowed = std::min(state_.before.least_weight, options_.lowest) - kLowerOnTheWay;
  const auto& rounds = state_.rounds;
  const bool stuck = rounds.size() >= kPatience &&
                     std::all_of(rounds.begin(), rounds.begin() + kPatience,
                                 [](const RefineRound& round) { return round.inserted == 0; });
  return stuck ? std::min(allowed, lowest_at_first_ - kLowerOnTheWay) : allowed;
}

void Refiner::refuse(const Found& found, RefineRound& round) {
  ++round.refused;
  state_.refused.push_back({static_cast<int>(state_.rounds.size()), found.point,
                            found.refusal.value_or(Refusal::system), found.value});
}

// Inserts all at once; if that increases the error or fails, one by one.
Status Refiner::insert(std::vector<Found>& found, RefineRound& round) {
  const auto try_points = [&](std::span<Found> some) -> Status {
    std::vector<double> points, rows;
    for (const Found& each : some) {
      points.insert(points.end(), each.point.begin(), each.point.end());
      rows.insert(rows.end(), each.row.begin(), each.row.end());
    }
    if (!solver_.insert(points, rows)) {
      for (Found& each : some) each.refusal = Refusal::system;
      return {};
    }
    const double lowest_before = lowest_;
    if (Status status = update(); !status) return status;
    RefineMetrics metrics = held_out_.errors(solver_.function(), *evaluator_);
    const bool lower = lowest_ < lowest_allowed(lowest_before);
    if (lower || has_grown(metrics)) {
      for (Found& each : some) {
        each.refusal = lower ? Refusal::weights : Refusal::growth;
        each.value = lower ? lowest_ : metrics.largest;
      }
      solver_.remove_last(static_cast<int>(some.size()));
      return update();
    }
    now_ = std::move(metrics);
    round.inserted += static_cast<int>(some.size());
    for (Found& each : some) {
      round.by_point += each.by_point ? 1 : 0;
      each.refusal.reset();
    }
    return {};
  };
  if (found.empty()) return {};
  if (Status status = try_points(found); !status) return status;
  if (found.front().refusal && found.size() > 1) {
    for (Found& each : found) {
      if (Status status = try_points({&each, 1}); !status) return status;
    }
  }
  for (const Found& each : found) {
    if (each.refusal) refuse(each, round);
  }
  return {};
}

Result<bool> Refiner::make_round() {
  const double usual = detail::usual_distance(solver_.function());
  double worst = 0;
  std::vector<Found> found = seek(usual, worst);
  if (found.empty() && !(worst > detail::kNegligible)) return false;
  parallel_for(found.size(), 1, options_.jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      detail::find_row(solver_, *evaluator_, measure_, options_, usual, found[i]);
    }
  });
  RefineRound round;
  if (!found.empty()) round.sought = found.front().sought;
  for (const Found& each : found) {
    if (each.refusal) refuse(each, round);
  }
  std::erase_if(found, [](const Found& each) { return each.refusal.has_value(); });
  if (Status status = insert(found, round); !status) return status.error();
  if (round.inserted > 0) held_out_.add_rest(solver_, *evaluator_, now_);
  round.after = now_;
  state_.rounds.push_back(std::move(round));
  return true;
}

Status check_options(const RefineOptions& o, int dimensions) {
  const auto wrong = [](const char* what) {
    return Error("fit-options", fmt::format("invalid refinement options: {}", what));
  };
  if (o.points < 0 || o.rounds < 0 || o.points_a_round < 1 || o.sweep < 0 || o.held_out < 0) {
    return wrong("negative number of points or rounds");
  }
  if (!o.tolerance.empty() && o.tolerance.size() != static_cast<std::size_t>(dimensions)) {
    return wrong("tolerances must be given for all parameters or none");
  }
  if (!(o.gain >= 0)) return wrong("gain is negative or NaN");
  if (std::ranges::any_of(o.tolerance, [](double t) { return !(t >= 0); })) {
    return wrong("a tolerance is negative or NaN");
  }
  if (!(o.scale > 0) || !(o.stay > 0) || !(o.positive >= 0) || !(o.slack >= 0) || !(o.least <= 0) ||
      !(o.largest >= 1) || !(o.lowest <= 0)) {
    return wrong("cost terms or weight limits are out of range");
  }
  return {};
}

}  // namespace

std::string_view refusal_name(Refusal refusal) {
  constexpr std::string_view kNames[] = {"weights", "residual", "near", "system", "growth"};
  return kNames[static_cast<std::size_t>(refusal)];
}

std::string_view stop_name(Stop stop) {
  constexpr std::string_view kNames[] = {"none",      "rounds", "points",
                                         "tolerance", "exact",  "stalled"};
  return kNames[static_cast<std::size_t>(stop)];
}

Result<Refined> refine(const Refined& start, const rbf::Measure& measure,
                       const RefineOptions& options, Progress& progress) {
  // Refinement continues with the rows as found.
  const Refined found = detail::without_polish(start);
  auto solver = WeightSolver::resume(found.function);
  if (!solver) return solver.error();
  if (Status status = check_options(options, start.function.dimensions); !status) {
    return status.error();
  }
  Refiner refiner(found, std::move(*solver), measure, options);
  if (Status status = refiner.begin(); !status) return status.error();
  if (Status status = refiner.run(progress); !status) return status.error();
  return std::move(refiner).take();
}

}  // namespace krok::fit
