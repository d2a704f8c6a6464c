// Would fail if finding weights, their slopes or corrected weights took memory: every operator new
// of this program is counted.

#include <gtest/gtest.h>

#include "rbf/inverse.h"
#include "rbf/weight_solver.h"
#include "support/counted_allocations.h"

namespace krok::rbf {
namespace {

TEST(Allocation, NoneForWeightsSlopesAndCorrections) {
  const auto solver =
      WeightSolver::create(2, std::vector<double>{0, 0, 1, 0, 0, 1, 1, 1, 0.5, 0.4});
  ASSERT_TRUE(solver.ok());
  const auto evaluator = WeightEvaluator::create(solver->function());
  ASSERT_TRUE(evaluator.ok());
  const Measure measure = [](std::span<const double> weights, std::span<double> out,
                             std::span<double> jacobian) -> Status {
    out[0] = weights[1] + weights[3] * weights[3];
    out[1] = weights[2] + weights[3];
    for (double& slope : jacobian) slope = 0;
    if (!jacobian.empty()) jacobian[1] = jacobian[7] = jacobian[8] = 1;
    if (!jacobian.empty()) jacobian[3] = 2 * weights[3];
    return {};
  };
  InverseSearch search(*evaluator, measure);
  std::vector<double> point = {0.3, 0.7}, moved = point, weights(5), slopes(10);
  const long before = test::allocations;
  evaluator->weights(point, weights);
  evaluator->slopes(point, weights, slopes);
  const Match corrected = search.correct(point, 2, 0, weights);
  const Match searched = search.find_point(point, 20, 1e-12, moved);
  EXPECT_EQ(test::allocations, before);
  EXPECT_LT(corrected.after, corrected.before);
  EXPECT_LT(searched.after, 1e-9);
}

}  // namespace
}  // namespace krok::rbf
