// Would fail if weights were not what the definition says: against scipy and numpy, closed forms,
// and a dense solution of the saddle system; or if inserting, taking back and going on gave other
// numbers than a solution from the start.

#include "rbf/weight_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "frozen_weights.h"
#include "rbf/weight_evaluator.h"
#include "support/special_values.h"
#include "unit/rbf/kernels.h"

namespace krok::rbf {
namespace {

using test::kKernels;
using test::kNan;
using test::weights_at;

using Values = std::vector<double>;

WeightSolver solver_of(int dimensions, const Values& examples, Kernel kernel) {
  auto solver = WeightSolver::create(dimensions, examples, {kernel, {}, {}});
  EXPECT_TRUE(solver.ok()) << solver.error().message;
  return std::move(*solver);
}

// The corners of the unit cube, and points that lie in it without coming close to each other: the
// additive recurrence of the generalised golden ratio.
Values cube_and_scattered(std::size_t count, std::size_t dimensions, double begin) {
  Values points;
  for (unsigned corner = 0; corner < 1u << dimensions; ++corner) {
    for (std::size_t i = 0; i < dimensions; ++i) points.push_back((corner >> i & 1u) != 0 ? 1 : 0);
  }
  double ratio = 2;
  for (int i = 0; i < 30; ++i)
    ratio = std::pow(1 + ratio, 1 / (1.0 + static_cast<double>(dimensions)));
  for (std::size_t k = 0; points.size() < count * dimensions; ++k) {
    for (std::size_t i = 0; i < dimensions; ++i) {
      const double step = std::pow(ratio, -1.0 - static_cast<double>(i));
      const double place = begin + static_cast<double>(k) * step;
      points.push_back(0.05 + 0.9 * (place - std::floor(place)));
    }
  }
  return points;
}

// Rows for points to insert: the weights there, changed a little.
Values rows_near(const WeightFunction& function, std::span<const double> points, unsigned seed) {
  std::mt19937 random(seed);
  const auto n = static_cast<std::size_t>(function.examples);
  const auto d = static_cast<std::size_t>(function.dimensions);
  Values rows;
  for (std::size_t p = 0; p < points.size(); p += d) {
    const Values point(points.begin() + static_cast<std::ptrdiff_t>(p),
                       points.begin() + static_cast<std::ptrdiff_t>(p + d));
    Values row = weights_at(function, point);
    for (std::size_t j = 0; j < n; ++j) {
      const double more = 0.002 * (random() % 10001) / 1e4;
      row[j] += more;
      row[(j + 1) % n] -= more;
    }
    rows.insert(rows.end(), row.begin(), row.end());
  }
  return rows;
}

TEST(WeightSolver, GivesTheNumbersOfScipyAndNumpy) {
  for (const test::Frozen& frozen : test::kFrozen) {
    WeightSolver solver = solver_of(2, test::kExamples, frozen.kernel);
    if (frozen.inserted) {
      ASSERT_TRUE(solver.insert(test::kInserted, test::kRows).ok());
    }
    for (int p = 0; p < 2; ++p) {
      const Values weights =
          weights_at(solver.function(), Values(test::kAt[p], std::end(test::kAt[p])));
      for (std::size_t j = 0; j < 9; ++j) {
        EXPECT_NEAR(weights[j], frozen.weights[p][j], 2e-13)
            << kernel_name(frozen.kernel) << " point " << p << " example " << j;
      }
    }
  }
}

TEST(WeightSolver, TwoExamplesAreInterpolatedLinearly) {
  for (const Kernel kernel : kKernels) {
    const WeightSolver solver = solver_of(1, {2, 6}, kernel);
    for (const double p : {2.0, 3.0, 6.0, 10.0, -2.0}) {
      const Values weights = weights_at(solver.function(), Values{p});
      EXPECT_NEAR(weights[0], (6 - p) / 4, 1e-15) << kernel_name(kernel);
      EXPECT_NEAR(weights[1], (p - 2) / 4, 1e-15) << kernel_name(kernel);
    }
    EXPECT_EQ(has_radii(kernel), !solver.function().radii.empty());
  }
}

TEST(WeightSolver, LinearKernelInOneDimensionJoinsTheExamplesByStraightLines) {
  const WeightSolver solver = solver_of(1, {0, 1, 3, 4}, Kernel::linear);
  const Values weights = weights_at(solver.function(), Values{1.5});
  EXPECT_THAT(weights, testing::Pointwise(testing::DoubleNear(1e-14), Values{0, 0.75, 0.25, 0}));
}

TEST(WeightSolver, CubicKernelInOneDimensionIsTheNaturalSpline) {
  // Through 0, 1, 0 at 0, 1, 2: 1.5 x - 0.5 x^3 on the first half, straight lines outside.
  const WeightSolver solver = solver_of(1, {0, 1, 2}, Kernel::cubic);
  for (const double x : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    EXPECT_NEAR(weights_at(solver.function(), Values{x})[1], 1.5 * x - 0.5 * x * x * x, 1e-15);
    EXPECT_NEAR(weights_at(solver.function(), Values{2 - x})[1], 1.5 * x - 0.5 * x * x * x, 1e-15);
  }
  EXPECT_NEAR(weights_at(solver.function(), Values{-1})[1], -1.5, 1e-14);
}

// The weights of examples at their own parameters, and the identities at other points, beyond the
// range, too.
void expect_identities(const WeightFunction& function, bool refined, const std::string& what) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  const auto n = static_cast<std::size_t>(function.examples);
  for (std::size_t i = 0; i < n; ++i) {
    const auto place = function.centre(static_cast<int>(i));
    const Values weights = weights_at(function, Values(place.begin(), place.end()));
    for (std::size_t j = 0; j < n; ++j) EXPECT_NEAR(weights[j], i == j ? 1 : 0, 1e-12) << what;
  }
  const Values at = cube_and_scattered((1u << d) + 50, d, 0.77);
  for (std::size_t p = 0; p < at.size(); p += d) {
    Values point(at.begin() + static_cast<std::ptrdiff_t>(p),
                 at.begin() + static_cast<std::ptrdiff_t>(p + d));
    for (double& value : point) value = 1.6 * value - 0.3;
    const Values weights = weights_at(function, point);
    EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-12) << what;
    if (refined) continue;
    for (std::size_t i = 0; i < d; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < n; ++j) sum += weights[j] * function.centres[j * d + i];
      EXPECT_NEAR(sum, point[i], 1e-12) << what;
    }
  }
}

TEST(WeightSolver, KeepsItsIdentities) {
  for (const Kernel kernel : kKernels) {
    for (const std::size_t d : {1u, 2u, 3u, 5u}) {
      const Values examples = cube_and_scattered((1u << d) + 6, d, 0.5);
      WeightSolver solver = solver_of(static_cast<int>(d), examples, kernel);
      const std::string what = std::string(kernel_name(kernel)) + " " + std::to_string(d);
      expect_identities(solver.function(), false, what);
      const Values more = cube_and_scattered((1u << d) + 20, d, 0.123);
      const auto points = std::span(more).subspan((1u << d) * d);
      const Status status = solver.insert(points, rows_near(solver.function(), points, 3));
      ASSERT_TRUE(status.ok()) << what << ": " << status.error().message;
      expect_identities(solver.function(), true, what);
    }
  }
}

// The saddle system of all centres at once, solved with full pivoting.
Values dense_weights(std::size_t d, const Values& centres, const Eigen::MatrixXd& rows,
                     const Values& point) {
  const auto m = static_cast<Eigen::Index>(centres.size() / d);
  const auto planes = static_cast<Eigen::Index>(d + 1);
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(m + planes, m + planes);
  const auto distance = [&](const double* a, const double* b) {
    double square = 0;
    for (std::size_t i = 0; i < d; ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(square);
  };
  Eigen::RowVectorXd at(m + planes);
  for (Eigen::Index i = 0; i < m; ++i) {
    const double* place = centres.data() + static_cast<std::size_t>(i) * d;
    for (Eigen::Index k = 0; k < m; ++k) {
      system(i, k) = std::pow(distance(place, centres.data() + static_cast<std::size_t>(k) * d), 3);
    }
    at[i] = std::pow(distance(place, point.data()), 3);
    system(i, m) = system(m, i) = 1;
    for (Eigen::Index a = 0; a + 1 < planes; ++a) {
      system(i, m + 1 + a) = system(m + 1 + a, i) = place[a];
    }
  }
  at[m] = 1;
  for (Eigen::Index a = 0; a + 1 < planes; ++a) at[m + 1 + a] = point[static_cast<std::size_t>(a)];
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(m + planes, rows.cols());
  right.topRows(m) = rows;
  const Eigen::RowVectorXd weights = at * system.fullPivLu().solve(right);
  return Values(weights.data(), weights.data() + weights.size());
}

TEST(WeightSolver, InsertingOneByOneIsTheDenseSolutionOfAll) {
  constexpr std::size_t d = 2, n = 9, more = 60;
  const Values all = cube_and_scattered(n + more, d, 0.11);
  const auto begin = all.begin();
  WeightSolver solver = solver_of(d, Values(begin, begin + n * d), Kernel::cubic);
  const Values rows = rows_near(solver.function(), std::span(all).subspan(n * d), 12);
  for (std::size_t p = 0; p < more; ++p) {
    ASSERT_TRUE(
        solver.insert(std::span(all).subspan((n + p) * d, d), std::span(rows).subspan(p * n, n))
            .ok());
  }
  Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(n + more, n);
  wanted.topRows(n).setIdentity();
  for (std::size_t p = 0; p < more; ++p) {
    for (std::size_t j = 0; j < n; ++j) {
      wanted(static_cast<Eigen::Index>(n + p), static_cast<Eigen::Index>(j)) = rows[p * n + j];
    }
  }
  for (const Values& point : {Values{0.3, 0.4}, Values{0.91, 0.05}, Values{1.2, 0.5}}) {
    EXPECT_THAT(
        weights_at(solver.function(), point),
        testing::Pointwise(testing::DoubleNear(1e-10), dense_weights(d, all, wanted, point)));
  }
  EXPECT_LT(solver.residual(), 1e-12);
}

TEST(WeightSolver, InsertingInAnyPortionsGivesTheSameBits) {
  for (const Kernel kernel : kKernels) {
    constexpr std::size_t d = 3, n = 12, more = 30;
    const Values all = cube_and_scattered(n + more, d, 0.21);
    const WeightSolver start = solver_of(d, Values(all.begin(), all.begin() + n * d), kernel);
    const Values rows = rows_near(start.function(), std::span(all).subspan(n * d), 22);
    WeightSolver at_once = start, one_by_one = start, with_detour = start;
    ASSERT_TRUE(at_once.insert(std::span(all).subspan(n * d), rows).ok());
    for (std::size_t p = 0; p < more; ++p) {
      const auto point = std::span(all).subspan((n + p) * d, d);
      const auto row = std::span(rows).subspan(p * n, n);
      ASSERT_TRUE(one_by_one.insert(point, row).ok());
      // A point that is taken back, and one that is refused, leave nothing behind.
      ASSERT_TRUE(with_detour.insert(Values{1.5, 0.2, 0.1}, row).ok());
      with_detour.remove_last(1);
      ASSERT_FALSE(with_detour.insert(std::span(all).first(d), row).ok());
      ASSERT_TRUE(with_detour.insert(point, row).ok());
    }
    EXPECT_EQ(at_once.function(), one_by_one.function()) << kernel_name(kernel);
    EXPECT_EQ(at_once.function(), with_detour.function()) << kernel_name(kernel);
    const auto resumed = WeightSolver::resume(at_once.function());
    ASSERT_TRUE(resumed.ok());
    EXPECT_EQ(resumed->function(), at_once.function()) << kernel_name(kernel);
  }
}

TEST(WeightSolver, RadiiStayWhenPointsComeIn) {
  WeightSolver solver = solver_of(2, {0, 0, 1, 0, 0, 1, 1, 1}, Kernel::bspline);
  EXPECT_THAT(solver.function().radii, testing::Each(2.0));
  const Values quarter(4, 0.25);
  ASSERT_TRUE(solver.insert(Values{0.5, 0.5}, quarter).ok());
  ASSERT_TRUE(solver.insert(Values{0.5, 0.4}, quarter).ok());
  const double half_diagonal = std::sqrt(0.5);
  EXPECT_THAT(
      solver.function().radii,
      testing::Pointwise(testing::DoubleNear(1e-15), Values{2, 2, 2, 2, 2 * half_diagonal, 0.2}));
  WeightSolver wide = solver_of(2, {0, 0, 1, 0, 0, 1, 1, 1}, Kernel::wendland);
  EXPECT_THAT(wide.function().radii, testing::Each(4.0));
}

TEST(WeightSolver, RefusesWhatHasNoWeights) {
  const auto code = [](int d, const Values& examples, const SolverOptions& options = {}) {
    const auto solver = WeightSolver::create(d, examples, options);
    return solver.ok() ? std::string("ok") : solver.error().code;
  };
  EXPECT_EQ(code(2, {0, 0, 1, 0, 0, 1}), "ok");
  EXPECT_EQ(code(0, {0, 1}), "rbf-dimensions");
  EXPECT_EQ(code(9, Values(90, 1.0)), "rbf-dimensions");
  EXPECT_EQ(code(2, {}), "rbf-examples");
  EXPECT_EQ(code(2, {0, 0, 1, 0}), "rbf-examples");
  EXPECT_EQ(code(2, {0, 0, 1, 0, 0, 1, 1}), "rbf-centres");
  EXPECT_EQ(code(1, {0, kNan, 1}), "rbf-number");
  EXPECT_EQ(code(1, {0, 1, std::numeric_limits<double>::infinity()}), "rbf-number");
  EXPECT_EQ(code(1, {3, 3, 3}), "rbf-bounds");
  EXPECT_EQ(code(1, {0, 1}, {Kernel::cubic, {1}, {0}}), "rbf-bounds");
  EXPECT_EQ(code(1, {0, 1}, {Kernel::cubic, {0}, {}}), "rbf-shape");
  EXPECT_EQ(code(1, {0, 1, 1}), "rbf-duplicate");
  EXPECT_EQ(code(1, {0, 1, 1 + 1e-8}), "rbf-duplicate");
  for (const Kernel kernel : kKernels) {
    EXPECT_EQ(code(2, {0, 0, 1, 1, 2, 2, 3, 3}, {kernel, {}, {}}), "rbf-rank");
  }
}

TEST(WeightSolver, RefusesPointsAndStaysAsItWas) {
  for (const Kernel kernel : kKernels) {
    WeightSolver solver = solver_of(2, test::kExamples, kernel);
    ASSERT_TRUE(solver.insert(test::kInserted, test::kRows).ok());
    const WeightFunction before = solver.function();
    const auto code = [&](const Values& points, const Values& rows) {
      const Status status = solver.insert(points, rows);
      EXPECT_EQ(solver.function(), before);
      return status.ok() ? std::string("ok") : status.error().code;
    };
    const Values row(9, 1.0 / 9);
    EXPECT_EQ(code({0.4, 0.4}, row), "rbf-duplicate");
    EXPECT_EQ(code({kNan, 0.4}, row), "rbf-number");
    EXPECT_EQ(code({0.5, 0.4}, Values(9, kNan)), "rbf-number");
    EXPECT_EQ(code({0.5, 0.4}, Values(9, 0.2)), "rbf-sum");
    // The first would do, the second is the first again.
    Values rows = row;
    rows.insert(rows.end(), row.begin(), row.end());
    EXPECT_EQ(code({0.5, 0.4, 0.5, 0.4}, rows), "rbf-duplicate");
  }
}

TEST(WeightSolver, EstimatesTheConditionAndTellsTroubleByIt) {
  const WeightSolver simplex = solver_of(2, {0, 0, 1, 0, 0, 1}, Kernel::cubic);
  EXPECT_EQ(simplex.condition(), 1);
  // One dimension, natural spline with one point off the base: a matrix of one element.
  EXPECT_NEAR(solver_of(1, {0, 1, 2}, Kernel::cubic).condition(), 1, 1e-14);
  // bspline at four corners: phi is 1 here, 0.25 beside, p across; the inverse's signs alternate.
  const double t = std::sqrt(2.0) / 2, p = 2 * std::pow(1 - t, 3);
  const double most = 1 + 0.5 + p, least = 1 - 0.5 + p;
  EXPECT_NEAR(solver_of(2, {0, 0, 1, 0, 0, 1, 1, 1}, Kernel::bspline).condition(), most / least,
              1e-12);
  WeightSolver solver = solver_of(2, test::kExamples, Kernel::cubic);
  const double before = solver.condition();
  const Values close = {0.6, 0.7 + 2e-4};
  ASSERT_TRUE(solver.insert(close, rows_near(solver.function(), close, 1)).ok());
  EXPECT_GT(solver.condition(), 1e3 * before);
}

TEST(WeightSolver, TakesBackWhatWasInserted) {
  WeightSolver solver = solver_of(2, test::kExamples, Kernel::gaussian);
  const WeightFunction start = solver.function();
  ASSERT_TRUE(solver.insert(test::kInserted, test::kRows).ok());
  solver.remove_last(1);
  EXPECT_EQ(solver.function().inserted(), 1);
  solver.remove_last(7);  // more than there are: examples stay
  EXPECT_EQ(solver.function(), start);
  solver.remove_last(-1);
  EXPECT_EQ(solver.function(), start);
}

}  // namespace
}  // namespace krok::rbf
