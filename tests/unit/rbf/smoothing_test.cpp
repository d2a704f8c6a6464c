// Would fail if smoothed weights were not the smoothing spline that the definition says (against
// scipy), lost their sums, did not tend to planes, or could not be gone on with.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

#include "frozen_weights.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"
#include "unit/rbf/kernels.h"

namespace krok::rbf {
namespace {

using test::kKernels;
using test::weights_at;

using Values = std::vector<double>;

// As in frozen_weights.h, by scipy's RBFInterpolator(..., smoothing=[s, .., s, 0, 0]): the
// examples' smoothing, none for inserted points.
struct Smoothed {
  Kernel kernel;
  bool inserted;
  double smoothing;
  double weights[2][9];
};
constexpr Smoothed kSmoothed[] = {
    {Kernel::cubic,
     false,
     0.05,
     {{0.10187418125770058, 0.24458388617977944, 0.04239556414805695, 0.004059695921059803,
       0.570000672041757, 0.06655985246669627, -0.019359809644738518, 0.04333184939390375,
       -0.05344589176421485},
      {-0.15097695542807665, -0.12266103997181083, 2.8408009411215494, 0.2004883807113325,
       -1.2321140714440992, -0.5301335875356514, 0.06993009336573341, -0.5947274100134534,
       0.519393649194494}}},
    {Kernel::cubic,
     true,
     0.05,
     {{0.1549167343434102, 0.16479473758909538, 0.06406867405834189, 0.11522370717087276,
       0.5632694306246835, -0.0386029706876409, -0.01145428811541066, 0.005389419060171707,
       -0.017605444043523183},
      {-0.25089451840252236, 0.010081104580020706, 2.743488917680218, -0.029450534890509333,
       -1.3038201939667986, -0.2528159511052178, 0.24825637795579814, -0.5697340645891958,
       0.4048888627382037}}},
    {Kernel::linear,
     false,
     0.2,
     {{0.13153527300675819, 0.24803531523269567, 0.10609300191364804, 0.0404297167563967,
       0.3999177551459219, 0.054132984336655206, 0.00716740845856563, 0.029233720634375834,
       -0.01654517548501787},
      {-0.09237231241640684, 0.49275809866821296, 1.3138008905676228, -0.4344284340838514,
       -0.019141923349415495, 0.27352501187452266, -0.5975249389464995, -0.19816400596919556,
       0.2615476136550098}}},
    {Kernel::linear,
     true,
     0.2,
     {{0.16199392862597295, 0.18443781220424343, 0.08196512544281576, 0.09507790092738631,
       0.502075663810907, -0.017208419854724325, -0.013234402193850109, 0.010459431721760566,
       -0.00556704068451172},
      {-0.09501711582591224, 0.4902835624348697, 1.3136997561202894, -0.4350197255264686,
       -0.02718886008239686, 0.28134064183220797, -0.5772080569984963, -0.21187532552176117,
       0.2609851235676681}}},
};

WeightSolver solver_of(Kernel kernel, double smoothing) {
  auto solver = WeightSolver::create(2, test::kExamples, {kernel, {}, {}, smoothing});
  EXPECT_TRUE(solver.ok()) << solver.error().message;
  return std::move(*solver);
}

TEST(Smoothing, GivesTheNumbersOfScipy) {
  for (const Smoothed& frozen : kSmoothed) {
    WeightSolver solver = solver_of(frozen.kernel, frozen.smoothing);
    if (frozen.inserted) {
      ASSERT_TRUE(solver.insert(test::kInserted, test::kRows).ok());
    }
    for (int p = 0; p < 2; ++p) {
      const Values weights = weights_at(solver.function(), test::kAt[p]);
      for (std::size_t j = 0; j < 9; ++j) {
        EXPECT_NEAR(weights[j], frozen.weights[p][j], 1e-12)
            << kernel_name(frozen.kernel) << " point " << p << " example " << j;
      }
    }
  }
}

TEST(Smoothing, KeepsBothSums) {
  for (const Kernel kernel : {Kernel::cubic, Kernel::linear}) {
    for (const double smoothing : {1e-4, 0.1, 100.0}) {
      const WeightSolver solver = solver_of(kernel, smoothing);
      for (const auto& at : test::kAt) {
        const Values weights = weights_at(solver.function(), at);
        EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-12);
        for (std::size_t d = 0; d < 2; ++d) {
          double sum = 0;
          for (std::size_t i = 0; i < 9; ++i) sum += weights[i] * test::kExamples[2 * i + d];
          EXPECT_NEAR(sum, at[d], 1e-10) << kernel_name(kernel) << " " << smoothing;
        }
      }
    }
  }
}

TEST(Smoothing, TendsToTheLeastSquaresPlanes) {
  Eigen::MatrixXd planes(9, 3);
  for (Eigen::Index i = 0; i < 9; ++i) {
    const auto k = static_cast<std::size_t>(2 * i);
    planes.row(i) << 1, test::kExamples[k], test::kExamples[k + 1];
  }
  for (const Kernel kernel : kKernels) {
    const WeightSolver solver = solver_of(kernel, 1e6);
    for (const auto& at : test::kAt) {
      const Eigen::VectorXd wanted = planes.transpose().completeOrthogonalDecomposition().solve(
          Eigen::Vector3d(1, at[0], at[1]));
      const Values weights = weights_at(solver.function(), at);
      for (std::size_t j = 0; j < 9; ++j) {
        EXPECT_NEAR(weights[j], wanted[static_cast<Eigen::Index>(j)], 1e-4) << kernel_name(kernel);
      }
    }
  }
}

// Inserted points are met, examples are not; a function that is gone on with has the same bits.
TEST(Smoothing, IsGoneOnWith) {
  for (const Kernel kernel : kKernels) {
    WeightSolver solver = solver_of(kernel, 0.05);
    ASSERT_TRUE(solver.insert(test::kInserted, test::kRows).ok());
    const WeightFunction& function = solver.function();
    for (int k = 0; k < 2; ++k) {
      const Values weights = weights_at(function, function.centre(9 + k));
      for (std::size_t j = 0; j < 9; ++j) {
        EXPECT_NEAR(weights[j], function.inserted_row(k)[j], 1e-9) << kernel_name(kernel);
      }
    }
    EXPECT_LT(weights_at(function, function.centre(4))[4], 0.99);
    const auto again = WeightSolver::resume(function);
    ASSERT_TRUE(again.ok()) << again.error().message;
    EXPECT_EQ(again->function(), function);
    solver.remove_last(2);
    EXPECT_EQ(solver.function(), solver_of(kernel, 0.05).function());
  }
}

TEST(Smoothing, RefusesWhatIsNone) {
  for (const double odd : {-0.1, std::nan(""), double(INFINITY)}) {
    const auto solver = WeightSolver::create(2, test::kExamples, {Kernel::cubic, {}, {}, odd});
    ASSERT_FALSE(solver.ok());
    EXPECT_EQ(solver.error().code, "rbf-number");
  }
}

}  // namespace
}  // namespace krok::rbf
