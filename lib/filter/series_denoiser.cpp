#include "filter/series_denoiser.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/parallel.h"
#include "math/transform.h"

namespace krok::filter {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Chosen on ten captures of the corpus (tests/filter/compare_filters.py, --set tuning): the error
// changes by 2 % at half and twice the window, and by 1 % with other shares and deviations.
constexpr double kWindow = 6, kLag = 0.1;  // seconds
constexpr int kMaxWindow = 300, kMinLag = 3, kMaxLag = 12;
constexpr double kShareOfCommon = 0.7;
constexpr double kLeftNoise = 0.7;  // deviation of the noise that is left in the common estimate

// How much of a component is signal: the shrinkage of its singular value, over it. `beta` is the
// ratio of the matrix's sides, the value in units of the noise.
double signal_share(double value, double beta) {
  if (value <= 1 + std::sqrt(beta)) return 0;
  const double square = value * value;
  return std::sqrt(std::max(0.0, std::pow(square - beta - 1, 2) - 4 * beta)) / square;
}

// One window by singular spectrum analysis: columns of the matrix are the pieces of `lag` frames.
// Only products of frames are needed: the matrix has as many rows as columns times lags.
MatrixXd common_part(const MatrixXd& window, int lag) {
  const auto frames = static_cast<int>(window.rows());
  const int pieces = frames - lag + 1;
  const Eigen::RowVectorXd mean = window.colwise().mean();
  const MatrixXd centred = window.rowwise() - mean;
  const MatrixXd products = centred * centred.transpose();
  MatrixXd gram = MatrixXd::Zero(pieces, pieces);
  for (int l = 0; l < lag; ++l) gram += products.block(l, l, pieces, pieces);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(gram);
  const double rows = static_cast<double>(lag) * static_cast<double>(window.cols());
  const double longer = std::max(rows, static_cast<double>(pieces));
  const double beta = std::min(rows, static_cast<double>(pieces)) / longer;
  VectorXd shares(pieces);
  for (int i = 0; i < pieces; ++i) {
    shares[i] = signal_share(std::sqrt(std::max(0.0, solver.eigenvalues()[i]) / longer), beta);
  }
  const MatrixXd projection =
      solver.eigenvectors() * shares.asDiagonal() * solver.eigenvectors().transpose();
  // Averaging over the pieces that a frame is in makes one matrix for all columns.
  MatrixXd smoother = MatrixXd::Zero(frames, frames);
  VectorXd count = VectorXd::Zero(frames);
  for (int l = 0; l < lag; ++l) {
    smoother.block(l, l, pieces, pieces) += projection;
    count.segment(l, pieces).array() += 1;
  }
  return (count.cwiseInverse().asDiagonal() * (smoother.transpose() * centred)).rowwise() + mean;
}

int window_of(double rate, int longest) {
  return std::min(longest, std::max(20, static_cast<int>(std::lround(kWindow * rate))));
}

MatrixXd common_part(const MatrixXd& series, double rate, int longest, int jobs) {
  const auto frames = static_cast<int>(series.rows());
  const int window = std::min(frames, window_of(rate, longest));
  const auto in_lag = static_cast<int>(std::lround(kLag * rate));
  const int lag = std::min(std::clamp(in_lag, kMinLag, kMaxLag), window / 2);
  std::vector<int> starts;
  for (int f = 0; f < frames - window; f += window / 2) starts.push_back(f);
  starts.push_back(frames - window);
  std::vector<MatrixXd> parts(starts.size());
  parallel_for(starts.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      parts[i] = common_part(MatrixXd(series.middleRows(starts[i], window)), lag);
    }
  });
  MatrixXd sum = MatrixXd::Zero(series.rows(), series.cols());
  VectorXd weights = VectorXd::Zero(series.rows());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (int f = 0; f < window; ++f) {
      const double weight = std::min(f + 1, window - f);
      sum.row(starts[i] + f) += weight * parts[i].row(f);
      weights[starts[i] + f] += weight;
    }
  }
  return weights.cwiseInverse().asDiagonal() * sum;
}

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

void smooth_columns(const Whittaker& smoother, Eigen::Ref<MatrixXd> series) {
  // Side by side, as a series by itself waits for its last value in each step.
  Rows rows = series;
  smoother.smooth({rows.data(), static_cast<std::size_t>(rows.size())},
                  static_cast<std::size_t>(rows.cols()));
  series = rows;
}

constexpr double kPart = 0.5, kFewestFrames = 15;  // seconds, frames
constexpr double kCaution = 2;                     // 0: in each part the best smoother alone
constexpr std::size_t kGroups = 4;

// A motion in parts of equal length that overlap by half and fade into each other linearly.
struct Parts {
  Parts(Eigen::Index frames, double length)
      : count(std::max<Eigen::Index>(
            2, static_cast<Eigen::Index>(std::ceil(static_cast<double>(frames - 1) / length)) + 1)),
        step(static_cast<double>(count - 1) / static_cast<double>(frames - 1)) {}

  // Calls take(part, share) for the two parts of a frame.
  template <typename Take>
  void of(Eigen::Index frame, const Take& take) const {
    const double place = step * static_cast<double>(frame);
    const auto part = std::min(count - 2, static_cast<Eigen::Index>(place));
    take(part, 1 - (place - static_cast<double>(part)));
    take(part + 1, place - static_cast<double>(part));
  }

  Eigen::Index count;
  double step;
};

Rows smoothed_in_parts(const Rows& series, const std::vector<Whittaker>& ladder,
                       const Parts& parts) {
  const auto frames = static_cast<double>(series.rows());
  const auto smoothed = [&](const Whittaker& smoother) {
    Rows smooth = series;
    smoother.smooth({smooth.data(), static_cast<std::size_t>(smooth.size())},
                    static_cast<std::size_t>(smooth.cols()));
    return smooth;
  };
  std::vector<Rows> weights;
  Rows least = Rows::Constant(parts.count, series.cols(), HUGE_VAL);
  for (const Whittaker& smoother : ladder) {
    const Rows smooth = smoothed(smoother);
    Rows& risks = weights.emplace_back(Rows::Zero(parts.count, series.cols()));
    for (Eigen::Index f = 0; f < series.rows(); ++f) {
      parts.of(f, [&](Eigen::Index part, double share) {
        risks.row(part).array() += share * ((smooth.row(f) - series.row(f)).array().square() +
                                            2 * smoother.freedom() / frames);
      });
    }
    for (Eigen::Index c = 0; c < series.cols(); c += 3) {
      risks.middleCols(c, 3).colwise() = risks.middleCols(c, 3).rowwise().sum().eval();
    }
    least = least.cwiseMin(risks);
  }
  Rows sum = Rows::Zero(parts.count, series.cols());
  for (Rows& of : weights) {
    of = ((least - of) / kCaution).array().exp();
    sum += of;
  }
  Rows result = Rows::Zero(series.rows(), series.cols());
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    const Rows smooth = smoothed(ladder[i]);
    weights[i].array() /= sum.array();
    for (Eigen::Index f = 0; f < series.rows(); ++f) {
      parts.of(f, [&](Eigen::Index part, double share) {
        result.row(f).array() += share * weights[i].row(part).array() * smooth.row(f).array();
      });
    }
  }
  return result;
}

MatrixXd smoothed_in_parts(const MatrixXd& series, double rate, int jobs) {
  const Eigen::Index frames = series.rows();
  if (frames < 5) return series;
  std::vector<Whittaker> ladder;
  for (int step = -4; step <= 16; ++step) {
    ladder.emplace_back(static_cast<int>(frames), std::pow(10.0, 0.5 * step));
  }
  const Parts parts(frames, std::max(kFewestFrames, kPart * rate));
  MatrixXd result(frames, series.cols());
  parallel_for(static_cast<std::size_t>(series.cols() / 3), kGroups, jobs,
               [&](std::size_t begin, std::size_t end) {
                 const auto first = static_cast<Eigen::Index>(3 * begin);
                 const auto count = static_cast<Eigen::Index>(3 * (end - begin));
                 result.middleCols(first, count) =
                     smoothed_in_parts(series.middleCols(first, count), ladder, parts);
               });
  return result;
}

}  // namespace

WhittakerLadder::WhittakerLadder(int size) {
  for (int step = -8; step <= 36; ++step) {
    smoothers_.emplace_back(size, std::pow(10.0, 0.25 * step));
  }
}

Risks WhittakerLadder::risks(const Eigen::Ref<const MatrixXd>& series, double noise) const {
  Risks risks;
  for (const Whittaker& smoother : smoothers_) {
    MatrixXd smoothed = series;
    smooth_columns(smoother, smoothed);
    risks.push_back((smoothed - series).squaredNorm() +
                    2 * noise * noise * smoother.freedom() * static_cast<double>(series.cols()));
  }
  return risks;
}

const Whittaker& WhittakerLadder::choose(const Risks& risks) const {
  return smoothers_[static_cast<std::size_t>(std::ranges::min_element(risks) - risks.begin())];
}

double noise_deviation(const Eigen::Ref<const MatrixXd>& series) {
  if (series.rows() < 5) return 0;
  double sum = 0;
  std::vector<double> sizes;
  for (Eigen::Index c = 0; c < series.cols(); ++c) {
    sizes.clear();
    for (Eigen::Index f = 0; f + 4 < series.rows(); ++f) {
      sizes.push_back(std::abs(series(f, c) - 4 * series(f + 1, c) + 6 * series(f + 2, c) -
                               4 * series(f + 3, c) + series(f + 4, c)));
    }
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    sum += *middle * *middle;
  }
  // The median of |x| is 0.6745 deviations; the squares of the five weights sum to 70.
  return std::sqrt(sum / static_cast<double>(series.cols()) / 70) / 0.6745;
}

MatrixXd without_noise_in_parts(const MatrixXd& series, double rate, int jobs) {
  constexpr int kLongest = 100;  // frames: with 300 it takes seven times as long, 3 % less is left
  return 0.5 * (common_part(series, rate, kLongest, jobs) + smoothed_in_parts(series, rate, jobs));
}

MatrixXd without_noise(const MatrixXd& series, double rate, int jobs,
                       std::span<const GroupRisks> known, std::vector<GroupRisks>* found) {
  const MatrixXd common = common_part(series, rate, kMaxWindow, jobs);
  const WhittakerLadder ladder(static_cast<int>(series.rows()));
  MatrixXd result(series.rows(), series.cols());
  const auto groups = static_cast<std::size_t>(series.cols() / 3);
  if (found != nullptr) found->resize(groups);
  parallel_for(groups, 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t group = begin; group < end; ++group) {
      const auto first = static_cast<Eigen::Index>(3 * group);
      MatrixXd joint = common.middleCols(first, 3), own = series.middleCols(first, 3);
      GroupRisks risks;
      if (known.empty()) risks = {ladder.risks(joint, kLeftNoise), ladder.risks(own, 1)};
      const GroupRisks& by = known.empty() ? risks : known[group];
      smooth_columns(ladder.choose(by.common), joint);
      smooth_columns(ladder.choose(by.own), own);
      result.middleCols(first, 3) = kShareOfCommon * joint + (1 - kShareOfCommon) * own;
      if (found != nullptr) (*found)[group] = by;
    }
  });
  return result;
}

int window_step(double rate) {
  return window_of(rate, kMaxWindow) / 2;
}

Whittaker::Whittaker(int size, double lambda, std::span<const double> weights)
    : weights_(weights.begin(), weights.end()),
      inverse_(at(size)),
      lower1_(at(size)),
      lower2_(at(size)),
      lambda_(lambda) {
  // Diagonals of D^T D, where D takes second differences.
  const auto second = [&](int first, int row) {
    if (first < 0 || first + 2 >= size) return 0.0;
    return row == first + 1 ? -2.0 : 1.0;
  };
  const auto product = [&](int i, int j) {
    double sum = 0;
    for (int first = j - 2; first <= i; ++first) sum += second(first, i) * second(first, j);
    return sum;
  };
  std::vector<double> diagonal(at(size));
  for (int i = 0; i < size; ++i) {
    double d = (weights_.empty() ? 1.0 : weights_[at(i)]) + lambda * product(i, i);
    double below1 = i + 1 < size ? lambda * product(i, i + 1) : 0;
    const double below2 = i + 2 < size ? lambda * product(i, i + 2) : 0;
    if (i > 0) {
      d -= lower1_[at(i - 1)] * lower1_[at(i - 1)] * diagonal[at(i - 1)];
      below1 -= lower1_[at(i - 1)] * lower2_[at(i - 1)] * diagonal[at(i - 1)];
    }
    if (i > 1) d -= lower2_[at(i - 2)] * lower2_[at(i - 2)] * diagonal[at(i - 2)];
    diagonal[at(i)] = d;
    inverse_[at(i)] = 1 / d;
    lower1_[at(i)] = below1 / d;
    lower2_[at(i)] = below2 / d;
    const double sine = std::sin(0.5 * kPi * i / size);
    freedom_ += 1 / (1 + lambda * std::pow(4 * sine * sine, 2));
  }
}

void Whittaker::smooth(std::span<double> values, std::size_t series) const {
  const std::size_t size = inverse_.size();
  if (size < 3) return;
  const auto scale = [&](std::size_t i, double by) {
    for (std::size_t s = 0; s < series; ++s) values[i * series + s] *= by;
  };
  const auto subtract = [&](std::size_t i, std::size_t other, double times) {
    double* const to = &values[i * series];
    const double* const from = &values[other * series];
    for (std::size_t s = 0; s < series; ++s) to[s] -= times * from[s];
  };
  for (std::size_t i = 0; i < size; ++i) {
    if (!weights_.empty()) scale(i, weights_[i]);
    if (i > 0) subtract(i, i - 1, lower1_[i - 1]);
    if (i > 1) subtract(i, i - 2, lower2_[i - 2]);
  }
  for (std::size_t i = size; i-- > 0;) {
    scale(i, inverse_[i]);
    if (i + 1 < size) subtract(i, i + 1, lower1_[i]);
    if (i + 2 < size) subtract(i, i + 2, lower2_[i]);
  }
}

double whittaker_lambda(double cutoff, double rate) {
  const double sine = std::sin(kPi * cutoff / rate);
  return 1 / std::pow(4 * sine * sine, 2);
}

}  // namespace krok::filter
