// Weights from parameters: lib/rbf beside a plain loop over centres and examples, compiled in this
// program with the same flags; inserting a centre beside a solution from the start; and what a
// point costs in refinement. Rounds take turns and the fastest of each counts; what is printed are
// ratios, which compare across machines, times of this one, and a hash of the results.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/hash.h"
#include "core/simd.h"
#include "fit/polish.h"
#include "rbf/sobol.h"
#include "rbf/weight_solver.h"
#include "support/arm.h"

namespace {

using namespace krok;
using Values = std::vector<double>;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kPoints = 256;  // a round

// The sum as it stands in the header of weight functions, cubic.
void plain_weights(const rbf::WeightFunction& f, const double* point, double* weights) {
  const auto d = static_cast<std::size_t>(f.dimensions), n = static_cast<std::size_t>(f.examples);
  double scaled[rbf::kMaxDimensions];
  for (std::size_t i = 0; i < d; ++i) {
    scaled[i] = (point[i] - f.lower[i]) / (f.upper[i] - f.lower[i]);
  }
  for (std::size_t j = 0; j < n; ++j) {
    weights[j] = f.affine[j];
    for (std::size_t i = 0; i < d; ++i) weights[j] += f.affine[(i + 1) * n + j] * scaled[i];
  }
  for (std::size_t k = 0; k < f.centres.size() / d; ++k) {
    double square = 0;
    for (std::size_t i = 0; i < d; ++i) {
      const double centre = (f.centres[k * d + i] - f.lower[i]) / (f.upper[i] - f.lower[i]);
      square += (scaled[i] - centre) * (scaled[i] - centre);
    }
    const double phi = square * std::sqrt(square);
    for (std::size_t j = 0; j < n; ++j) weights[j] += phi * f.coefficients[k * n + j];
  }
}

// A library of an arm's poses and its function with points inserted.
struct Library {
  std::string name;
  test::Arm arm;
  rbf::WeightFunction function;
  std::optional<rbf::WeightEvaluator> evaluator;
  Values points;                  // [kPoints x d]
  Values weights, plain, slopes;  // what comes out
  double fit_seconds = 1e9;       // for a point
  double polish_seconds = 1e9;
};

Library make_library(const std::string& name, int dimensions, int points) {
  Library library{name, test::make_arm(dimensions, 3), {}, {}, {}, {}, {}, {}};
  const auto solver = rbf::WeightSolver::create(dimensions, library.arm.parameters);
  if (!solver) std::abort();
  fit::Refined start;
  start.function = solver->function();
  fit::RefineOptions options;
  options.points = points;
  options.jobs = 1;
  Progress quiet;
  for (int round = 0; round < 5; ++round) {
    const auto begin = Clock::now();
    const auto refined = fit::refine(start, library.arm.measure(), options, quiet);
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    if (!refined || refined->function.inserted() != points) std::abort();
    library.fit_seconds = std::min(library.fit_seconds, seconds / points);
    library.function = refined->function;
    const auto polish_begin = Clock::now();
    if (!fit::polish(*refined, library.arm.measure(), options)) std::abort();
    const double more = std::chrono::duration<double>(Clock::now() - polish_begin).count();
    library.polish_seconds = std::min(library.polish_seconds, more / points);
  }
  auto evaluator = rbf::WeightEvaluator::create(library.function);
  if (!evaluator) std::abort();
  library.evaluator = std::move(*evaluator);
  library.points = rbf::points_inside(library.function, kPoints, 9, {});
  const auto n = static_cast<std::size_t>(library.function.examples);
  library.weights.resize(kPoints * n);
  library.plain.resize(kPoints * n);
  library.slopes.resize(n * static_cast<std::size_t>(dimensions));
  return library;
}

struct Part {
  std::string name;
  double items;  // a round
  std::function<void()> run;
  double best = 1e9;  // seconds a round
  double each() const { return best / items; }
};

// Rounds in turn, so that what slows the machine for a while slows all alike.
void measure(std::vector<Part>& parts, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    for (Part& part : parts) {
      const auto begin = Clock::now();
      part.run();
      part.best = std::min(part.best, std::chrono::duration<double>(Clock::now() - begin).count());
    }
  }
}

void evaluate(Library& library) {
  const auto d = static_cast<std::size_t>(library.function.dimensions);
  const auto n = static_cast<std::size_t>(library.function.examples);
  const auto each = [&](const auto& body) {
    for (std::size_t p = 0; p < kPoints; ++p) body(p * d, p * n);
  };
  const auto packed = [&] {
    each([&](std::size_t point, std::size_t row) {
      library.evaluator->weights(std::span(library.points).subspan(point, d),
                                 std::span(library.weights).subspan(row, n));
    });
  };
  const auto limited = [&](Simd most) {
    limit_simd(most);
    packed();
    limit_simd(Simd::avx512);
  };
  std::vector<Part> parts = {{"plain loop", kPoints,
                              [&] {
                                each([&](std::size_t point, std::size_t row) {
                                  plain_weights(library.function, library.points.data() + point,
                                                library.plain.data() + row);
                                });
                              }},
                             {"weights", kPoints, packed},
                             {"weights, AVX2", kPoints, [&] { limited(Simd::avx2); }},
                             {"weights and slopes", kPoints, [&] {
                                each([&](std::size_t point, std::size_t row) {
                                  library.evaluator->slopes(
                                      std::span(library.points).subspan(point, d),
                                      std::span(library.weights).subspan(row, n), library.slopes);
                                });
                              }}};
  measure(parts, 300);
  std::printf("%s: %d centres, %d examples\n", library.name.c_str(),
              library.function.centre_count(), library.function.examples);
  for (const Part& part : parts) {
    std::printf("  %-24s %8.0f ns a point, plain / this %.1f\n", part.name.c_str(),
                part.each() * 1e9, parts[0].best / part.best);
  }
  double difference = 0;
  for (std::size_t i = 0; i < library.plain.size(); ++i) {
    difference = std::max(difference, std::abs(library.plain[i] - library.weights[i]));
  }
  std::printf("  largest difference %.1e, hash of the weights %s\n", difference,
              hex(xxh3(std::as_bytes(std::span(library.weights)))).c_str());
}

void insert(const Library& library) {
  auto solver = rbf::WeightSolver::resume(library.function);
  if (!solver) std::abort();
  const int last = library.function.centre_count() - 1;
  const auto point = library.function.centre(last);
  const auto row = library.function.inserted_row(library.function.inserted() - 1);
  solver->remove_last(1);
  std::vector<Part> parts = {{"from the start", 1,
                              [&] {
                                if (!rbf::WeightSolver::resume(library.function)) std::abort();
                              }},
                             {"insert and take back", 2, [&] {
                                if (!solver->insert(point, row)) std::abort();
                                solver->remove_last(1);
                              }}};
  measure(parts, 30);
  std::printf("  a centre inserted %.0f us, solved from the start %.0f us: %.1f\n",
              parts[1].each() * 1e6, parts[0].each() * 1e6, parts[0].each() / parts[1].each());
  std::printf("  refinement %.2f ms a point, all of it, polishing %.2f ms, on one thread\n",
              library.fit_seconds * 1e3, library.polish_seconds * 1e3);
}

}  // namespace

int main() {
  Library libraries[] = {make_library("two dimensions", 2, 81),
                         make_library("three dimensions", 3, 163)};
  for (Library& library : libraries) {
    evaluate(library);
    insert(library);
  }
  return 0;
}
