#pragma once

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "rbf/weight_evaluator.h"

namespace krok::test {

inline constexpr rbf::Kernel kKernels[] = {rbf::Kernel::cubic, rbf::Kernel::linear,
                                           rbf::Kernel::gaussian, rbf::Kernel::bspline,
                                           rbf::Kernel::wendland};

inline std::vector<double> weights_at(const rbf::WeightFunction& function,
                                      std::span<const double> point) {
  const auto evaluator = rbf::WeightEvaluator::create(function);
  EXPECT_TRUE(evaluator.ok()) << evaluator.error().message;
  std::vector<double> weights(static_cast<std::size_t>(function.examples));
  evaluator->weights(point, weights);
  return weights;
}

}  // namespace krok::test
