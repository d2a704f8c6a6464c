// Would fail if the changes of rows were not the least-squares solution, as dense linear algebra
// gives it, or weights that are too low cost nothing.

#include "fit/joint_rows_internal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace krok::fit::detail {
namespace {

JointRows random_problem(std::size_t points, std::size_t dimensions, std::size_t rows,
                         std::size_t examples) {
  std::mt19937 random(20);
  const auto values = [&](std::size_t count) {
    std::vector<double> made(count);
    for (double& value : made) value = static_cast<double>(random()) / 2147483648.0 - 1;
    return made;
  };
  return {points,
          dimensions,
          rows,
          examples,
          values(points * rows),
          std::vector<double>(points * examples, 1.0 / static_cast<double>(examples)),
          values(points * dimensions),
          values(points * dimensions * examples)};
}

// The Jacobian of all errors by all rows' weights, whose sums stay.
Eigen::MatrixXd jacobian_of(const JointRows& p) {
  const auto index = [](std::size_t i) { return static_cast<Eigen::Index>(i); };
  Eigen::MatrixXd jacobian(index(p.points * p.dimensions), index(p.rows * p.examples));
  for (std::size_t r = 0; r < p.points * p.dimensions; ++r) {
    const Eigen::Map<const Eigen::VectorXd> slopes(&p.slopes[r * p.examples], index(p.examples));
    for (std::size_t k = 0; k < p.rows; ++k) {
      jacobian.row(index(r)).segment(index(k * p.examples), index(p.examples)) =
          p.influences[r / p.dimensions * p.rows + k] *
          (slopes.array() - slopes.mean()).matrix().transpose();
    }
  }
  return jacobian;
}

TEST(JointRows, AreTheLeastSquaresSolution) {
  const JointRows problem = random_problem(60, 2, 7, 5);
  const JointTerms terms = {.stay = 0.3, .positive = 0, .low = -1, .iterations = 500};
  const std::vector<double> changes = joint_changes(problem, terms, 1);
  const Eigen::MatrixXd jacobian = jacobian_of(problem);
  const Eigen::Map<const Eigen::VectorXd> errors(problem.errors.data(), jacobian.rows());
  const Eigen::Map<const Eigen::VectorXd> found(changes.data(), jacobian.cols());
  const auto cost = [&](const Eigen::VectorXd& x) {
    return (errors + jacobian * x).squaredNorm() / 60 + 0.3 * 0.3 * x.squaredNorm() / 7;
  };
  const Eigen::MatrixXd normal =
      jacobian.transpose() * jacobian / 60 +
      0.09 / 7 * Eigen::MatrixXd::Identity(jacobian.cols(), jacobian.cols());
  const Eigen::VectorXd best = normal.ldlt().solve(-jacobian.transpose() * errors / 60);
  ASSERT_LT(cost(best), 0.8 * cost(Eigen::VectorXd::Zero(best.size())));
  EXPECT_LT(cost(found), 1.001 * cost(best));
  EXPECT_LT((found - best).norm(), 0.05 * best.norm());
  for (std::size_t k = 0; k < 7; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < 5; ++i) sum += changes[k * 5 + i];
    EXPECT_NEAR(sum, 0, 1e-14);
  }
  EXPECT_EQ(joint_changes(problem, terms, 4), changes);
}

TEST(JointRows, RaiseWeightsThatAreTooLow) {
  JointRows problem = random_problem(20, 1, 3, 4);
  std::ranges::fill(problem.errors, 0.0);
  std::ranges::fill(problem.slopes, 0.0);
  std::ranges::fill(problem.influences, 0.0);
  problem.influences[0] = 1;  // the first row at the first point
  problem.weights = {-0.5, 0.5, 0.5, 0.5};
  problem.weights.resize(80, 0.25);
  const std::vector<double> changes =
      joint_changes(problem, {.stay = 1e-3, .positive = 1, .low = -0.1, .iterations = 100}, 1);
  EXPECT_NEAR(problem.weights[0] + changes[0], -0.1, 1e-2);
  for (std::size_t i = 4; i < changes.size(); ++i) EXPECT_EQ(changes[i], 0);
}

TEST(JointRows, NothingToGainChangesNothing) {
  JointRows problem = random_problem(20, 2, 3, 4);
  std::ranges::fill(problem.errors, 0.0);
  const JointTerms terms = {.stay = 0.1, .positive = 0.1, .low = -1, .iterations = 10};
  EXPECT_EQ(joint_changes(problem, terms, 1), std::vector<double>(12, 0.0));
}

}  // namespace
}  // namespace krok::fit::detail
