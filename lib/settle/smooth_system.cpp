#include "settle/smooth_system_internal.h"

#include <array>

#include "core/index.h"

namespace krok::settling {

SmoothSystem::SmoothSystem(int frames, Eigen::Index size)
    : matrix_(at(frames)),
      one_before_(at(frames)),
      two_before_(at(frames)),
      right_(at(frames)),
      size_(size) {
  clear();
}

void SmoothSystem::clear() {
  for (std::size_t f = 0; f < matrix_.size(); ++f) {
    for (auto* block : {&matrix_[f], &one_before_[f], &two_before_[f]}) {
      block->setZero(size_, size_);
    }
    right_[f].setZero(size_);
  }
}

const std::vector<Eigen::VectorXd>& SmoothSystem::solve(std::span<const Eigen::VectorXd> values,
                                                        int before, const Eigen::VectorXd& bend) {
  constexpr std::array<double, 3> kDifference = {1, -2, 1};
  const int count = static_cast<int>(values.size());
  for (int first = 0; first + 2 < count; ++first) {
    const Eigen::VectorXd bent =
        values[at(first)] - 2 * values[at(first + 1)] + values[at(first + 2)];
    for (int i = 0; i < 3; ++i) {
      const int row = first + i - before;
      if (row < 0) continue;
      right_[at(row)] -= kDifference[at(i)] * bend.cwiseProduct(bent);
      for (int k = 0; k <= i; ++k) {
        if (first + k < before) continue;
        auto& block = i == k ? matrix_ : i - k == 1 ? one_before_ : two_before_;
        block[at(row)].diagonal() += kDifference[at(i)] * kDifference[at(k)] * bend;
      }
    }
  }
  // Each block becomes the factor's; lower triangles on the diagonal.
  const int frames = count - before;
  const auto lower = [&](int f) { return matrix_[at(f)].triangularView<Eigen::Lower>(); };
  for (int f = 0; f < frames; ++f) {
    Eigen::MatrixXd& own = matrix_[at(f)];
    Eigen::MatrixXd& one = one_before_[at(f)];
    Eigen::MatrixXd& two = two_before_[at(f)];
    if (f >= 2) {
      lower(f - 2).transpose().solveInPlace<Eigen::OnTheRight>(two);
      one.noalias() -= two * one_before_[at(f - 1)].transpose();
      own.selfadjointView<Eigen::Lower>().rankUpdate(two, -1);
    }
    if (f >= 1) {
      lower(f - 1).transpose().solveInPlace<Eigen::OnTheRight>(one);
      own.selfadjointView<Eigen::Lower>().rankUpdate(one, -1);
    }
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(own);
    Eigen::VectorXd& right = right_[at(f)];
    if (f >= 1) right -= one * right_[at(f - 1)];
    if (f >= 2) right -= two * right_[at(f - 2)];
    lower(f).solveInPlace(right);
  }
  for (int f = frames - 1; f >= 0; --f) {
    Eigen::VectorXd& right = right_[at(f)];
    if (f + 1 < frames) right -= one_before_[at(f + 1)].transpose() * right_[at(f + 1)];
    if (f + 2 < frames) right -= two_before_[at(f + 2)].transpose() * right_[at(f + 2)];
    lower(f).transpose().solveInPlace(right);
  }
  return right_;
}

}  // namespace krok::settling
