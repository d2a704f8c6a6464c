// Would fail if the influence of an inserted point's row were not what the weights change by when
// the row does: whoever moves many rows at once would move them to the wrong place.

#include <gtest/gtest.h>

#include <cmath>

#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"
#include "unit/rbf/kernels.h"

namespace krok::rbf {
namespace {

using test::kKernels;

using Values = std::vector<double>;

const Values kExamples = {0, 0, 2, 0, 0, 3, 2, 3, 1, 1.4};
const Values kInserted = {0.5, 0.8, 1.4, 2.2, 1.6, 0.5};
constexpr std::size_t kRows = 3, kCount = 5;

WeightSolver with_points(Kernel kernel, double smoothing) {
  auto solver = WeightSolver::create(2, kExamples, {kernel, {}, {}, smoothing});
  EXPECT_TRUE(solver.ok());
  const Values rows = {0.5,  0.1, 0.2, 0,   0.2,  // each of sum 1
                       -0.1, 0.2, 0.3, 0.4, 0.2, 0.1, 0.55, 0, 0.1, 0.25};
  EXPECT_TRUE(solver->insert(kInserted, rows).ok());
  return *std::move(solver);
}

Values weights_of(const WeightFunction& function, const Values& point) {
  Values weights(kCount);
  const auto evaluator = WeightEvaluator::create(function);
  EXPECT_TRUE(evaluator.ok());
  evaluator->weights(point, weights);
  return weights;
}

TEST(Influence, IsWhatWeightsChangeByWithARow) {
  for (const Kernel kernel : kKernels) {
    for (const double smoothing : {0.0, 0.05}) {
      if (smoothing > 0 && has_radii(kernel)) continue;
      const WeightSolver solver = with_points(kernel, smoothing);
      for (std::size_t k = 0; k < kRows; ++k) {
        WeightFunction moved = solver.function();
        moved.inserted_rows[k * kCount + 1] += 0.3;
        moved.inserted_rows[k * kCount + 4] -= 0.3;
        const auto again = WeightSolver::resume(moved);
        ASSERT_TRUE(again.ok());
        // Inside, outside, and at an example of the base or not.
        for (const Values& point : {Values{0.9, 1.1}, {1.9, 2.8}, {-0.5, 4}, {0, 0}, {1, 1.4}}) {
          Values influences(kRows);
          solver.influences(point, influences);
          const Values before = weights_of(solver.function(), point);
          const Values after = weights_of(again->function(), point);
          EXPECT_NEAR(after[1] - before[1], 0.3 * influences[k], 1e-11) << kernel_name(kernel);
          EXPECT_NEAR(after[4] - before[4], -0.3 * influences[k], 1e-11);
          EXPECT_NEAR(after[0] - before[0], 0, 1e-11);
        }
      }
    }
  }
}

TEST(Influence, IsAllAtItsOwnPointAndNoneAtOthers) {
  for (const Kernel kernel : kKernels) {
    const WeightSolver solver = with_points(kernel, 0);
    for (int c = 0; c < solver.function().centre_count(); ++c) {
      Values influences(kRows);
      solver.influences(solver.function().centre(c), influences);
      for (std::size_t k = 0; k < kRows; ++k) {
        const bool own = c == static_cast<int>(kCount + k);
        EXPECT_NEAR(influences[k], own ? 1 : 0, 1e-11) << kernel_name(kernel) << " " << c;
      }
    }
  }
}

TEST(Influence, NoPointsHaveNone) {
  const auto solver = WeightSolver::create(2, kExamples);
  ASSERT_TRUE(solver.ok());
  solver->influences(Values{1, 1}, {});
}

}  // namespace
}  // namespace krok::rbf
