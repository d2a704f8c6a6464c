// Would fail if vector instructions, tails or many points at once changed a bit of the weights, if
// slopes were not the derivatives, if numbers that do not belong together were accepted, or if
// evaluation took memory.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/simd.h"
#include "rbf/evaluate_internal.h"
#include "rbf/sobol.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"
#include "support/special_values.h"
#include "unit/rbf/kernels.h"

namespace krok::rbf {
namespace {

using test::kKernels;
using test::kNan;

using Values = std::vector<double>;

// A function that no examples gave: any numbers of the right sums.
WeightFunction any_function(Kernel kernel, int dimensions, int examples, int centres) {
  WeightFunction f;
  f.kernel = kernel;
  f.dimensions = dimensions;
  f.examples = examples;
  const auto d = static_cast<std::size_t>(dimensions), n = static_cast<std::size_t>(examples),
             m = static_cast<std::size_t>(centres);
  const Sobol sobol(dimensions, 3);
  Values point(d);
  for (std::uint32_t k = 0; k < m; ++k) {
    sobol.point(k, point);
    for (const double value : point) f.centres.push_back(3 * value - 1);
    if (has_radii(kernel)) f.radii.push_back(0.2 + 0.01 * (k % 7));
  }
  f.lower.assign(d, -1.0);
  f.upper.assign(d, 2.0);
  const auto fill = [&](Values& rows, std::size_t count, double first, double others) {
    for (std::size_t r = 0; r < count; ++r) {
      double sum = 0;
      for (std::size_t j = 0; j + 1 < n; ++j) {
        rows.push_back(std::sin(1.0 + static_cast<double>(r * n + j)));
        sum += rows.back();
      }
      rows.push_back((r == 0 ? first : others) - sum);
    }
  };
  fill(f.affine, d + 1, 1, 0);
  fill(f.coefficients, m, 0, 0);
  fill(f.inserted_rows, m - n, 1, 1);
  return f;
}

WeightEvaluator evaluator_of(const WeightFunction& function) {
  auto evaluator = WeightEvaluator::create(function);
  EXPECT_TRUE(evaluator.ok()) << evaluator.error().message;
  return std::move(*evaluator);
}

bool same_bits(const Values& a, const Values& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// Runs the rest of a test with at most these instructions.
class WithSimd {
 public:
  explicit WithSimd(Simd most) { limit_simd(most); }
  ~WithSimd() { limit_simd(Simd::avx512); }
};

TEST(WeightEvaluator, GivesTheSameBitsWithEveryInstructionSet) {
  for (const Kernel kernel : kKernels) {
    for (const int d : {1, 2, 3, 8}) {
      for (const int n : {9, 10, 12, 13, 15, 16, 17, 27}) {
        for (const int more : {0, 1, 7, 250, 300}) {
          const WeightFunction f = any_function(kernel, d, n, n + more);
          const WeightEvaluator evaluator = evaluator_of(f);
          const auto examples = static_cast<std::size_t>(n);
          Values point(f.centres.end() - d, f.centres.end());  // the last centre
          for (int p = 0; p < 2; ++p) {
            Values scalar(examples), scalar_slopes(examples * static_cast<std::size_t>(d));
            {
              const WithSimd with(Simd::other);
              evaluator.slopes(point, scalar, scalar_slopes);
            }
            for (const Simd simd : {Simd::avx2, Simd::avx512}) {
              const WithSimd with(simd);
              Values weights(examples), both(examples), slopes(scalar_slopes.size());
              evaluator.weights(point, weights);
              evaluator.slopes(point, both, slopes);
              ASSERT_TRUE(same_bits(scalar, weights)) << kernel_name(kernel) << d << " " << n;
              ASSERT_TRUE(same_bits(scalar, both)) << kernel_name(kernel) << d << " " << n;
              ASSERT_TRUE(same_bits(scalar_slopes, slopes))
                  << kernel_name(kernel) << " " << d << " " << n << " " << more;
            }
            for (double& value : point) value = 0.37 * value + 0.1;
          }
        }
      }
    }
  }
}

TEST(WeightEvaluator, IsTheSumThatTheHeaderSays) {
  for (const Kernel kernel : kKernels) {
    const WeightFunction f = any_function(kernel, 3, 11, 40);
    const Values point = {0.31, 1.2, -0.4};
    Values weights(11), scaled(3);
    evaluator_of(f).weights(point, weights);
    f.scale(point, scaled);
    for (std::size_t j = 0; j < 11; ++j) {
      double expected = f.affine[j];
      for (std::size_t i = 0; i < 3; ++i) expected += scaled[i] * f.affine[(i + 1) * 11 + j];
      for (std::size_t k = 0; k < 40; ++k) {
        Values centre(3);
        f.scale(f.centre(static_cast<int>(k)), centre);
        const double r =
            std::hypot(scaled[0] - centre[0], scaled[1] - centre[1], scaled[2] - centre[2]);
        const double t = has_radii(kernel) ? r / f.radii[k] : r;
        const double phi = kernel == Kernel::cubic      ? t * t * t
                           : kernel == Kernel::linear   ? t
                           : kernel == Kernel::gaussian ? std::exp(-4 * t * t)
                           : t >= 1                     ? 0
                           : kernel == Kernel::wendland ? std::pow(1 - t, 4) * (4 * t + 1)
                           : t <= 0.5                   ? 1 - 6 * t * t + 6 * t * t * t
                                                        : 2 * std::pow(1 - t, 3);
        expected += phi * f.coefficients[k * 11 + j];
      }
      EXPECT_NEAR(weights[j], expected, 1e-13) << kernel_name(kernel);
    }
  }
}

TEST(WeightEvaluator, GaussianIsTheExponentialFromOneToNothing) {
  for (double t = 0; t < 15; t += 0.013) {
    const double value = detail::basis_scalar(Kernel::gaussian, t * t, 1).value;
    const double expected = std::exp(-4 * t * t);
    EXPECT_NEAR(value, expected, 4e-16 * expected + 1e-304) << t;
  }
  EXPECT_EQ(detail::basis_scalar(Kernel::gaussian, 0, 1).value, 1);
  EXPECT_EQ(detail::basis_scalar(Kernel::gaussian, 1e9, 1).value, 0);
}

TEST(WeightEvaluator, SlopesAreTheDerivatives) {
  for (const Kernel kernel : kKernels) {
    WeightFunction f = any_function(kernel, 2, 9, 30);
    f.upper[1] = 5;  // ranges that differ
    const WeightEvaluator evaluator = evaluator_of(f);
    Values point = {0.123, 1.7}, weights(9), slopes(18), above(9), below(9);
    evaluator.slopes(point, weights, slopes);
    for (std::size_t a = 0; a < 2; ++a) {
      const double middle = point[a], step = 1e-5;
      point[a] = middle + step;
      evaluator.weights(point, above);
      point[a] = middle - step;
      evaluator.weights(point, below);
      point[a] = middle;
      for (std::size_t j = 0; j < 9; ++j) {
        EXPECT_NEAR(slopes[a * 9 + j], (above[j] - below[j]) / (2 * step), 2e-7)
            << kernel_name(kernel);
      }
    }
    // At a centre all are finite.
    const auto centre = f.centre(20);
    evaluator.slopes(centre, weights, slopes);
    EXPECT_THAT(slopes, testing::Each(testing::Truly([](double s) { return std::isfinite(s); })));
  }
}

TEST(WeightEvaluator, SumsToOneFarOutsideTheRange) {
  for (const Kernel kernel : kKernels) {
    const WeightEvaluator evaluator = evaluator_of(any_function(kernel, 2, 9, 20));
    Values weights(9);
    evaluator.weights(Values{1e4, -1e4}, weights);
    double sum = 0, largest = 1;
    for (const double weight : weights) {
      sum += weight;
      largest = std::max(largest, std::abs(weight));
    }
    EXPECT_NEAR(sum, 1, 1e-15 * largest * 9) << kernel_name(kernel);
    evaluator.weights(Values{kNan, 0}, weights);
    EXPECT_TRUE(std::isnan(weights[0]));
  }
}

TEST(WeightFunction, RefusesNumbersThatDoNotBelongTogether) {
  const WeightFunction good = any_function(Kernel::gaussian, 2, 9, 12);
  ASSERT_TRUE(good.check().ok());
  const auto code = [&](auto change) {
    WeightFunction f = good;
    change(f);
    const auto evaluator = WeightEvaluator::create(f);
    const auto solver = WeightSolver::resume(f);
    EXPECT_EQ(evaluator.ok(), false);
    EXPECT_EQ(solver.ok(), false);
    return evaluator.ok() ? std::string("ok") : evaluator.error().code;
  };
  EXPECT_EQ(code([](auto& f) { f.kernel = static_cast<Kernel>(9); }), "rbf-kernel");
  EXPECT_EQ(code([](auto& f) { f.dimensions = 0; }), "rbf-dimensions");
  EXPECT_EQ(code([](auto& f) { f.dimensions = -3; }), "rbf-dimensions");
  EXPECT_EQ(code([](auto& f) { f.dimensions = 1 << 30; }), "rbf-dimensions");
  EXPECT_EQ(code([](auto& f) { f.examples = 2; }), "rbf-examples");
  EXPECT_EQ(code([](auto& f) { f.examples = -1; }), "rbf-examples");
  EXPECT_EQ(code([](auto& f) { f.examples = std::numeric_limits<int>::max(); }), "rbf-examples");
  EXPECT_EQ(code([](auto& f) { f.centres.pop_back(); }), "rbf-centres");
  EXPECT_EQ(code([](auto& f) { f.centres.resize(10); }), "rbf-centres");
  EXPECT_EQ(code([](auto& f) { f.lower.clear(); }), "rbf-shape");
  EXPECT_EQ(code([](auto& f) { f.upper.push_back(1); }), "rbf-shape");
  EXPECT_EQ(code([](auto& f) { f.radii.pop_back(); }), "rbf-shape");
  EXPECT_EQ(code([](auto& f) { f.affine.pop_back(); }), "rbf-shape");
  EXPECT_EQ(code([](auto& f) { f.coefficients.push_back(0); }), "rbf-shape");
  EXPECT_EQ(code([](auto& f) { f.inserted_rows.clear(); }), "rbf-shape");
  EXPECT_EQ(code([](auto& f) { f.coefficients[3] = kNan; }), "rbf-number");
  EXPECT_EQ(code([](auto& f) { f.centres[0] = kNan; }), "rbf-number");
  EXPECT_EQ(code([](auto& f) { std::swap(f.lower[0], f.upper[0]); }), "rbf-bounds");
  EXPECT_EQ(code([](auto& f) { f.lower[0] = -1.7e308, f.upper[0] = 1.7e308; }), "rbf-bounds");
  EXPECT_EQ(code([](auto& f) { f.radii[2] = 0; }), "rbf-radius");
  EXPECT_EQ(code([](auto& f) { f.radii[2] = 1e-200; }), "rbf-radius");
  EXPECT_EQ(code([](auto& f) { f.affine[0] += 0.1; }), "rbf-sum");
  EXPECT_EQ(code([](auto& f) { f.coefficients[0] += 0.1; }), "rbf-sum");
  EXPECT_EQ(code([](auto& f) { f.inserted_rows[0] += 0.1; }), "rbf-sum");
}

TEST(WeightFunction, KernelsHaveNames) {
  for (const Kernel kernel : kKernels) EXPECT_EQ(kernel_named(kernel_name(kernel)), kernel);
  EXPECT_EQ(kernel_named("cubical"), std::nullopt);
  EXPECT_EQ(kernel_named(""), std::nullopt);
}

}  // namespace
}  // namespace krok::rbf
