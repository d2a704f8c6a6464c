// Would fail if the weights at a few points were not those of the function that the solver makes,
// so that a kernel or a smoothing would be chosen that predicts worse.

#include "rbf/weight_solver.h"

#include <gtest/gtest.h>

#include "core/index.h"
#include "rbf/sobol.h"
#include "unit/rbf/kernels.h"

namespace krok::rbf {
namespace {

TEST(PointWeights, AreTheSolversAtAnyPoint) {
  for (const int d : {1, 2, 4}) {
    std::vector<double> values;
    const Sobol sequence(d);
    for (int i = 0; i < 45; ++i) {
      std::vector<double> point(static_cast<std::size_t>(d));
      sequence.point(static_cast<std::uint32_t>(i), point);
      // Ranges of their own: lengths beside angles.
      for (std::size_t k = 0; k < point.size(); ++k)
        values.push_back(3 + 7 * point[k] * double(k + 1));
    }
    const auto split = static_cast<std::ptrdiff_t>(40 * d);
    const std::vector<double> examples(values.begin(), values.begin() + split);
    const std::vector<double> asked(values.begin() + split, values.end());
    for (const Kernel kernel : test::kKernels) {
      for (const double smoothing : {0.0, 0.01, 3.0}) {
        const auto found = point_weights(d, examples, kernel, smoothing, asked);
        ASSERT_TRUE(found.ok()) << found.error().message;
        SolverOptions options;
        options.kernel = kernel;
        options.smoothing = smoothing;
        const auto solver = WeightSolver::create(d, examples, options);
        ASSERT_TRUE(solver.ok()) << solver.error().message;
        for (std::size_t p = 0; p < 5; ++p) {
          const auto point = std::span(asked).subspan(p * at(d), at(d));
          const std::vector<double> wanted = test::weights_at(solver->function(), point);
          for (std::size_t i = 0; i < 40; ++i) {
            EXPECT_NEAR((*found)[p * 40 + i], wanted[i], 1e-9)
                << kernel_name(kernel) << " " << smoothing << " in " << d;
          }
        }
      }
    }
  }
}

TEST(PointWeights, ExamplesThatCannotBeToldApartAreRefused) {
  const std::vector<double> same = {0, 1, 1, 2};
  const auto twice = point_weights(1, same, Kernel::cubic, 0.1, same);
  ASSERT_FALSE(twice.ok());
  EXPECT_EQ(twice.error().code, "rbf-duplicate");
  const auto few = point_weights(2, same, Kernel::cubic, 0, same);
  ASSERT_FALSE(few.ok());
  EXPECT_EQ(few.error().code, "rbf-examples");
}

}  // namespace
}  // namespace krok::rbf
