// How right steps of given parameters are, by the ways there are to choose weights: libraries of
// one to four parameters out of generated walks, and one of captured ones where there is a corpus;
// and errors at points inside them that no way was fitted to. Prints a table in Markdown; times are
// of this machine and one thread.

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "bench/step_libraries.h"
#include "core/numbers.h"
#include "fit/polish.h"
#include "parametric/bounds.h"
#include "parametric/measure.h"
#include "parametric/synthesise.h"
#include "rbf/sobol.h"
#include "rbf/weight_function.h"
#include "rbf/weight_solver.h"

namespace {

using namespace krok;
using namespace krok::parametric;
using Clock = std::chrono::steady_clock;

constexpr int kPoints = 1000;
constexpr std::uint64_t kSeed = 20'11;  // other points than refinement holds out

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct Errors {
  // Millimetres, of the lengths; 95 % of them have no more than `most`.
  double largest = 0, most = 0, mean = 0;
  double turn = 0;  // degrees, the largest
};

class Trial {
 public:
  Trial(std::string name, Library library)
      : name_(std::move(name)),
        library_(std::move(library)),
        packed_(pack_examples(library_)),
        measure_(library_, packed_),
        bounds_(bounds_of(library_)),
        d_(library_.parameters.size()),
        n_(library_.examples.size()) {
    std::vector<double> parameters;
    for (const Example& example : library_.examples) {
      parameters.insert(parameters.end(), example.parameters.begin(), example.parameters.end());
    }
    parameters_ = std::move(parameters);
  }

  void run(const std::vector<int>& points) {
    const auto plain = solve(rbf::Kernel::cubic);
    unrefined_roughness_ = roughness(plain);
    // Without the margin, where some ways would have nothing to go by.
    Bounds hull = bounds_;
    hull.margin = 0;
    points_ = rbf::points_inside(plain, kPoints, kSeed, [&](std::span<const double> point) {
      return outside(hull, point).distance <= 0;
    });
    fmt::print("| **{}, {} examples** | | | | | | | | | |\n", name_, n_);
    row_of_function("cubic, not refined", plain, 0);
    row("nearest example", 0, [this](auto point, auto weights) { nearest(point, weights); });
    row("barycentric, of the nearest examples", 0,
        [this](auto point, auto weights) { barycentric(point, weights); });
    corrected(plain);
    for (const int inserted : points) refined(rbf::Kernel::cubic, inserted, plain);
    const rbf::WeightFunction last = refined_;
    clamped(last);
    refined(rbf::Kernel::gaussian, points.back(), solve(rbf::Kernel::gaussian));
    recomputed(refined_);
  }

 private:
  using Weigh = std::function<void(std::span<const double>, std::span<double>)>;

  rbf::Inside inside() const {
    return [this](std::span<const double> point) { return outside(bounds_, point).distance <= 0; };
  }

  rbf::WeightFunction solve(rbf::Kernel kernel) const {
    const auto solver =
        rbf::WeightSolver::create(static_cast<int>(d_), parameters_, {kernel, {}, {}});
    if (solver) return solver->function();
    fmt::print(stderr, "{}\n", solver.error().message);
    std::exit(1);
  }

  double roughness(const rbf::WeightFunction& function) const {
    const auto actors = rbf::weight_metrics(function, 256, inside());
    return actors ? actors->roughness : NAN;
  }

  Errors errors_of(const Weigh& weigh, double& least) const {
    Errors errors;
    std::vector<double> weights(n_), measured(d_);
    auto scratch = measure_.make_scratch();
    std::vector<double> lengths;
    for (std::size_t p = 0; p < points_.size(); p += d_) {
      const auto point = std::span(points_).subspan(p, d_);
      weigh(point, weights);
      least = std::min(least, *std::ranges::min_element(weights));
      if (!measure_(weights, measured, {}, scratch)) continue;
      for (std::size_t d = 0; d < d_; ++d) {
        const double error = std::abs(measured[d] - point[d]);
        if (library_.parameters[d].quantity == Quantity::step_turn) {
          errors.turn = std::max(errors.turn, error / kRadiansPerDegree);
        } else if (library_.parameters[d].quantity != Quantity::duration) {
          lengths.push_back(1e3 * error);
        }
      }
    }
    if (lengths.empty()) return errors;
    std::ranges::sort(lengths);
    errors.largest = lengths.back();
    errors.most = lengths[(lengths.size() * 95 + 99) / 100 - 1];
    errors.mean =
        std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
    return errors;
  }

  double nanoseconds_of(const Weigh& weigh) const {
    std::vector<double> weights(n_);
    double best = 1e9;
    for (int round = 0; round < 20; ++round) {
      // A way that takes long is timed once.
      if (best < 1e9 && best > 0.05) break;
      const auto begin = Clock::now();
      for (std::size_t p = 0; p < points_.size(); p += d_) {
        weigh(std::span(points_).subspan(p, d_), weights);
      }
      best = std::min(best, seconds_since(begin));
    }
    return best * static_cast<double>(d_) / static_cast<double>(points_.size()) * 1e9;
  }

  void row(const std::string& name, int inserted, const Weigh& weigh, double roughness = NAN,
           double milliseconds = NAN) const {
    double least = 1;
    const Errors errors = errors_of(weigh, least);
    const auto shown = [](double value, int digits) {
      return std::isnan(value) ? std::string() : fmt::format("{:.{}f}", value, digits);
    };
    fmt::print(
        "| {} | {} | {:.4f} | {:.4f} | {:.4f} | {} | {:.2f} | {} | {} | {:.0f} |\n", name, inserted,
        errors.largest, errors.most, errors.mean, shown(d_ > 2 ? errors.turn : NAN, 3), least,
        shown(roughness / unrefined_roughness_, 2), shown(milliseconds, 2), nanoseconds_of(weigh));
  }

  void row_of_function(const std::string& name, const rbf::WeightFunction& function, int inserted,
                       double milliseconds = NAN) const {
    const auto evaluator = rbf::WeightEvaluator::create(function);
    if (!evaluator) return;
    row(
        name, inserted, [&](auto point, auto weights) { evaluator->weights(point, weights); },
        roughness(function), milliseconds);
  }

  void nearest(std::span<const double> point, std::span<double> weights) const {
    double best = INFINITY;
    std::size_t which = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      double square = 0;
      for (std::size_t d = 0; d < d_; ++d) {
        const double apart =
            (point[d] - parameters_[i * d_ + d]) / (bounds_.upper[d] - bounds_.lower[d]);
        square += apart * apart;
      }
      if (square < best) {
        best = square;
        which = i;
      }
    }
    std::ranges::fill(weights, 0.0);
    weights[which] = 1;
  }

  // Of the simplices of nearby examples that hold a point, the one whose examples are nearest to it
  // (what Delaunay's triangulation would give); the nearest example where there is none.
  void barycentric(std::span<const double> point, std::span<double> weights) const {
    const auto d = static_cast<Eigen::Index>(d_);
    Eigen::MatrixXd apart(d, static_cast<Eigen::Index>(n_));  // from the point, scaled
    for (Eigen::Index i = 0; i < apart.cols(); ++i) {
      for (Eigen::Index k = 0; k < d; ++k) {
        const auto p = static_cast<std::size_t>(k);
        apart(k, i) = (parameters_[static_cast<std::size_t>(i) * d_ + p] - point[p]) /
                      (bounds_.upper[p] - bounds_.lower[p]);
      }
    }
    std::vector<Eigen::Index> order(n_);
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::ranges::sort(order, {}, [&](Eigen::Index i) { return apart.col(i).squaredNorm(); });
    nearest(point, weights);
    const std::size_t near = std::min<std::size_t>(n_, d_ < 4 ? 14 : 16);
    std::vector<bool> chosen(near, false);
    std::fill(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(d_) + 1, true);
    double best = INFINITY;
    do {
      Eigen::MatrixXd system(d + 1, d + 1);
      std::vector<Eigen::Index> corners;
      for (std::size_t k = 0; k < near; ++k) {
        if (chosen[k]) corners.push_back(order[k]);
      }
      for (Eigen::Index k = 0; k <= d; ++k) {
        system.col(k).head(d) = apart.col(corners[static_cast<std::size_t>(k)]);
        system(d, k) = 1;
      }
      const Eigen::VectorXd parts = system.partialPivLu().solve(Eigen::VectorXd::Unit(d + 1, d));
      if (!parts.allFinite() || parts.minCoeff() < -1e-9) continue;
      if ((system * parts - Eigen::VectorXd::Unit(d + 1, d)).norm() > 1e-9) continue;
      double cost = 0;
      for (Eigen::Index k = 0; k <= d; ++k) {
        cost += parts[k] * system.col(k).head(d).squaredNorm();
      }
      if (cost >= best) continue;
      best = cost;
      std::ranges::fill(weights, 0.0);
      for (Eigen::Index k = 0; k <= d; ++k) {
        weights[static_cast<std::size_t>(corners[static_cast<std::size_t>(k)])] = parts[k];
      }
    } while (std::prev_permutation(chosen.begin(), chosen.end()));
  }

  // Two Gauss-Newton steps at run time, from unrefined weights.
  void corrected(const rbf::WeightFunction& plain) const {
    const auto synthesiser = Synthesiser::create(library_, plain);
    if (!synthesiser) return;
    row("cubic, corrected at run time", 0, [&](auto point, auto weights) {
      const auto synthesis = synthesiser->weights(point, {.extrapolate = true, .corrections = 2});
      if (synthesis) std::ranges::copy(synthesis->weights, weights.begin());
    });
  }

  void refined(rbf::Kernel kernel, int inserted, const rbf::WeightFunction& plain) {
    fit::RefineOptions options;
    options.points = inserted;
    options.jobs = 1;
    options.inside = inside();
    fit::Refined start;
    start.function = plain;
    Progress progress;
    const rbf::Measure measure = [this](auto weights, auto parameters, auto jacobian) {
      thread_local Measure::Scratch scratch;
      scratch = measure_.make_scratch();
      return measure_(weights, parameters, jacobian, scratch);
    };
    const auto begin = Clock::now();
    const auto result = fit::refine(start, measure, options, progress);
    const double seconds = seconds_since(begin);
    if (!result) return;
    refined_ = result->function;
    const int count = refined_.inserted();
    const auto ms_a_point = [&](double all) { return 1e3 * all / std::max(1, count); };
    row_of_function(fmt::format("{}, refined", rbf::kernel_name(kernel)), refined_, count,
                    ms_a_point(seconds));
    const auto polish_begin = Clock::now();
    const auto polished = fit::polish(*result, measure, options);
    const double polish_seconds = seconds_since(polish_begin);
    if (!polished) return;
    refined_ = polished->function;
    row_of_function(polished->polished ? "the same, polished" : "the same, polishing gains nothing",
                    refined_, count, ms_a_point(seconds + polish_seconds));
  }

  // What destroys both identities of the weights: that they sum to 1 with sum w_i p_i = p.
  void clamped(const rbf::WeightFunction& function) const {
    const auto evaluator = rbf::WeightEvaluator::create(function);
    if (!evaluator) return;
    row("the same, clamped and brought to sum 1", function.inserted(),
        [&](auto point, auto weights) {
          evaluator->weights(point, weights);
          double sum = 0;
          for (double& weight : weights) sum += weight = std::max(0.0, weight);
          for (double& weight : weights) weight /= sum;
        });
  }

  // Radii by the nearest of all centres, instead of those there were when each came in.
  void recomputed(rbf::WeightFunction function) const {
    const auto count = static_cast<std::size_t>(function.centre_count());
    std::vector<double> places(count * d_);
    for (std::size_t k = 0; k < count; ++k) {
      function.scale(function.centre(static_cast<int>(k)), std::span(places).subspan(k * d_, d_));
    }
    for (std::size_t k = 0; k < count; ++k) {
      double least = INFINITY;
      for (std::size_t i = 0; i < count; ++i) {
        if (i == k) continue;
        double square = 0;
        for (std::size_t d = 0; d < d_; ++d) {
          square += std::pow(places[k * d_ + d] - places[i * d_ + d], 2);
        }
        least = std::min(least, std::sqrt(square));
      }
      function.radii[k] = 2 * least;
    }
    const auto solver = rbf::WeightSolver::resume(function);
    if (!solver) {
      fmt::print("| the same, radii recomputed | {} | {} | | | | | | |\n", function.inserted(),
                 solver.error().message);
      return;
    }
    row_of_function("the same, radii recomputed", solver->function(), function.inserted());
  }

  const std::string name_;
  const Library library_;
  const PackedExamples packed_;
  const Measure measure_;
  const Bounds bounds_;
  const std::size_t d_, n_;
  std::vector<double> parameters_;  // [examples x d]
  std::vector<double> points_;      // [points x d]
  rbf::WeightFunction refined_;
  double unrefined_roughness_ = 1;
};

}  // namespace

int main() {
  fmt::print(
      "| weights | points inserted | largest error, mm | 95 %, mm | mean, mm | largest turn, "
      "degrees "
      "| least weight | roughness, of the unrefined | fitting, ms a point | a weight evaluation, "
      "ns "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  const std::vector<int> points[] = {{10, 20}, {20, 80}, {40, 160}, {160, 320}};
  for (int d = 1; d <= 4; ++d) {
    Trial(counted(d, "parameter"), bench::grid_library(d)).run(points[d - 1]);
  }
  Library captured = bench::walkset_library();
  if (captured.examples.empty()) return 0;
  Trial("captured walks by length and duration", std::move(captured)).run({20, 80});
}
