#include "parametric/example_sums.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pose/packed_pose.h"

namespace krok::parametric {

namespace {

constexpr double kDenser = 2;            // poses for each of the examples'
constexpr double kMaxSumFrames = 1024;   // bounds the memory for motions of any duration
constexpr double kWorthwhile = 1.0 / 4;  // of the examples
constexpr std::size_t kFloats = sizeof(PoseBlock) / sizeof(float);

// Poses of all examples at one generic time, in the hemispheres of the mean.
void sample_examples(const PackedExamples& packed, double generic, std::span<PoseBlock> reference,
                     std::span<PoseBlock> scratch, std::span<PoseBlock> poses) {
  const std::size_t blocks = reference.size();
  const GenericTimePoint place = generic_place(packed.generic, generic);
  sample_pose(packed.reference, generic, reference);
  for (std::size_t i = 0; i < packed.clips.size(); ++i) {
    sample_pose(packed.clips[i], example_time(packed, place, static_cast<int>(i)), scratch);
    const auto pose = poses.subspan(i * blocks, blocks);
    clear_sum(pose);
    add_to_sum(scratch, 1, reference, pose);
  }
}

// The largest root of the summed squares of the examples' deviations from their mean: of any
// joint's position, and twice that of its rotation, an angle.
double spread_of(std::span<const PoseBlock> poses, std::size_t examples, std::size_t blocks) {
  double largest = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    for (int lane = 0; lane < PoseBlock::kLanes; ++lane) {
      Eigen::Matrix<double, 7, 1> sum, squares;
      sum.setZero();
      squares.setZero();
      for (std::size_t i = 0; i < examples; ++i) {
        const PoseBlock& block = poses[i * blocks + b];
        Eigen::Matrix<double, 7, 1> values;
        for (int c = 0; c < 3; ++c) values[c] = block.position[c][lane];
        for (int c = 0; c < 4; ++c) values[3 + c] = block.rotation[c][lane];
        sum += values;
        squares += values.cwiseAbs2();
      }
      squares -= sum.cwiseAbs2() / static_cast<double>(examples);
      largest = std::max({largest, squares.head<3>().sum(), 4 * squares.tail<4>().sum()});
    }
  }
  return std::sqrt(largest);
}

}  // namespace

std::optional<ExampleSums> ExampleSums::create(const PackedExamples& packed,
                                               std::span<const std::span<const double>> rows) {
  const auto examples = static_cast<std::size_t>(packed.examples());
  if (packed.examples() < kMinExamples || rows.empty()) return {};
  ExampleSums sums;
  double rate = 0;
  for (const PackedClip& clip : packed.clips) rate = std::max(rate, clip.rate);
  const double last = packed.generic.back();
  const double count = std::clamp(std::ceil(last * rate * kDenser), 1.0, kMaxSumFrames);
  sums.rate_ = count / last;
  sums.frames_ = static_cast<int>(count) + 1;
  sums.blocks_ = static_cast<std::size_t>(packed.reference.blocks_per_pose());
  std::vector<PoseBlock> reference(sums.blocks_), scratch(sums.blocks_);
  std::vector<PoseBlock> poses(examples * sums.blocks_);
  for (const double generic : packed.generic) {
    sample_examples(packed, generic, reference, scratch, poses);
    sums.spread_ = std::max(sums.spread_, spread_of(poses, examples, sums.blocks_));
  }

  // Gram-Schmidt, each time with the row that is farthest from the span so far.
  const auto n = static_cast<Eigen::Index>(examples);
  const auto row_count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd rest(n, row_count);
  for (Eigen::Index r = 0; r < row_count; ++r) {
    rest.col(r) = Eigen::Map<const Eigen::VectorXd>(rows[static_cast<std::size_t>(r)].data(), n);
  }
  const auto most = static_cast<Eigen::Index>(kWorthwhile * static_cast<double>(examples));
  Eigen::MatrixXd basis(n, most);
  Eigen::Index made = 0;
  Eigen::VectorXd next = Eigen::VectorXd::Constant(n, 1);
  for (;;) {
    // Twice, as once is not orthogonal to rounding.
    for (int again = 0; again < 2; ++again) {
      const Eigen::VectorXd inside = basis.leftCols(made).transpose() * next;
      next -= basis.leftCols(made) * inside;
    }
    basis.col(made) = next.normalized();
    const Eigen::RowVectorXd parts = basis.col(made).transpose() * rest;
    rest -= basis.col(made) * parts;
    ++made;
    Eigen::Index farthest = 0;
    const double far = std::sqrt(rest.colwise().squaredNorm().maxCoeff(&farthest));
    if (far * sums.spread_ <= 0.5 * kMaxLeftOut) break;
    if (made == most) return {};
    next = rest.col(farthest);
  }
  sums.basis_ = basis.leftCols(made);

  const auto columns = static_cast<std::size_t>(made);
  sums.sums_.assign(static_cast<std::size_t>(sums.frames_) * columns * sums.blocks_, {});
  std::vector<double> total(kFloats * sums.blocks_);
  for (int f = 0; f < sums.frames_; ++f) {
    sample_examples(packed, f / sums.rate_, reference, scratch, poses);
    for (std::size_t c = 0; c < columns; ++c) {
      std::ranges::fill(total, 0);
      for (std::size_t i = 0; i < examples; ++i) {
        const double weight =
            sums.basis_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c));
        const float* values = poses[i * sums.blocks_].position[0];
        for (std::size_t k = 0; k < total.size(); ++k) total[k] += weight * double(values[k]);
      }
      const std::size_t first = (static_cast<std::size_t>(f) * columns + c) * sums.blocks_;
      float* into = sums.sums_[first].position[0];
      for (std::size_t k = 0; k < total.size(); ++k) into[k] = static_cast<float>(total[k]);
    }
  }
  return sums;
}

std::vector<float> ExampleSums::coefficients(std::span<const double> weights,
                                             double& left_out) const {
  const Eigen::Map<const Eigen::VectorXd> row(weights.data(), basis_.rows());
  const Eigen::VectorXd inside = basis_.transpose() * row;
  left_out = spread_ * (row - basis_ * inside).norm();
  std::vector<float> result;
  for (Eigen::Index c = 0; c < inside.size(); ++c) {
    result.push_back(static_cast<float>(inside[c]));
  }
  return result;
}

void ExampleSums::add(double generic, std::span<const float> coefficients,
                      std::span<PoseBlock> sum) const {
  const double place = std::clamp(generic * rate_, 0.0, static_cast<double>(frames_ - 1));
  const int frame = std::min(static_cast<int>(place), frames_ - 2);
  const auto part = static_cast<float>(place - frame);
  const std::size_t columns = coefficients.size(), floats = kFloats * blocks_;
  float* __restrict into = sum.front().position[0];
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t first = (static_cast<std::size_t>(frame) * columns + c) * blocks_;
    const float* __restrict before = sums_[first].position[0];
    const float* __restrict after = sums_[first + columns * blocks_].position[0];
    const float weight_after = coefficients[c] * part;
    const float weight_before = coefficients[c] - weight_after;
    for (std::size_t k = 0; k < floats; ++k) {
      into[k] += weight_before * before[k] + weight_after * after[k];
    }
  }
}

}  // namespace krok::parametric
