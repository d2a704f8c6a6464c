#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

// Whittaker smoothing: penalised least squares of evenly sampled values.

namespace krok::filter {

// Minimises sum w[i] (y[i] - x[i])^2 + lambda sum (second difference of y)^2. Linear, zero-phase; a
// straight line is unchanged. A value of weight 0 is interpolated by a cubic spline. After
// Whittaker (Proceedings of the Edinburgh Mathematical Society 41, 1923) and Eilers (Analytical
// Chemistry 75, 2003).
class Whittaker {
 public:
  // `lambda` > 0, finite. `weights`: one for each value, >= 0, at least two above 0; empty: all 1.
  Whittaker(int size, double lambda, std::span<const double> weights = {});

  // In place, of `size` values each of so many series, of which the first values come first. Fewer
  // than three values are unchanged.
  void smooth(std::span<double> values, std::size_t series = 1) const;

  // Degrees of freedom: the trace of the matrix that smooths, for weights of 1. From its
  // eigenvalues in the cosine basis, within 1 of the exact trace.
  double freedom() const { return freedom_; }
  double lambda() const { return lambda_; }

 private:
  std::vector<double> weights_;
  // L D L^T of the pentadiagonal matrix: 1 / D, and L's two lower diagonals.
  std::vector<double> inverse_, lower1_, lower2_;
  double lambda_, freedom_ = 0;
};

// The lambda for which the gain is 1/2 at `cutoff` Hz, 0 < cutoff <= rate / 2.
double whittaker_lambda(double cutoff, double rate);

// Removes white noise of known deviation from many series at once.

// The expected error with each smoother of a WhittakerLadder, up to a constant. Those of parts of a
// motion may be added.
using Risks = std::vector<double>;

// Whittaker smoothers for a range of lambdas, to choose from for each group of series.
class WhittakerLadder {
 public:
  explicit WhittakerLadder(int size);

  // For these columns together, by Mallows' Cp, where noise has this standard deviation in each
  // value.
  Risks risks(const Eigen::Ref<const Eigen::MatrixXd>& series, double noise) const;
  const Whittaker& choose(const Risks& risks) const;  // the smoother with the least

 private:
  std::vector<Whittaker> smoothers_;
};

// The white noise in evenly sampled columns that are smooth but for it: standard deviation, from
// the median of fourth differences, so that fast frames and outliers have little effect. 0 for
// fewer than five rows.
double noise_deviation(const Eigen::Ref<const Eigen::MatrixXd>& series);

// Columns are series (three a group: the axes of one joint), rows are frames; noise of deviation 1
// in each value, independent of the others. Two estimates are joined:
// - what the columns have in common over short times: singular spectrum analysis of all columns
//   with lags over 0.1 s, in windows of up to 6 s; singular values are shrunk by Gavish and Donoho
//   (IEEE Transactions on Information Theory 63, 2017). Limbs move together, so a quick change that
//   no column shows above its noise may be plain in all of them.
// - Whittaker smoothing of each group, its strength by Mallows' Cp.
// Same bytes for any `jobs`.
//
// `known` (optional, [groups]): the risks that strengths are chosen by, instead of those of these
// series. `found` (optional) gets them.
struct GroupRisks {
  Risks common, own;  // of the two estimates
};
Eigen::MatrixXd without_noise(const Eigen::MatrixXd& series, double rate, int jobs,
                              std::span<const GroupRisks> known = {},
                              std::vector<GroupRisks>* found = nullptr);

// Frames from a window of without_noise() to the next, the first of which begins at frame 0, where
// there are more frames than in a window.
int window_step(double rate);

// The same in a tenth of the time, and nearer for positions of joints: windows of up to 100 frames;
// each group by the mean of Whittaker smoothers of many strengths, in each half second weighted by
// what they would be wrong by (exponential weights, Leung and Barron, IEEE Transactions on
// Information Theory 52, 2006) as Mallows' Cp estimates it.
Eigen::MatrixXd without_noise_in_parts(const Eigen::MatrixXd& series, double rate, int jobs);

}  // namespace krok::filter
