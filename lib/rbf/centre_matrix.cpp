#include "rbf/centre_matrix_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/dense_solve.h"
#include "rbf/evaluate_internal.h"

namespace krok::rbf::detail {

namespace {

double square_distance(std::span<const double> a, std::span<const double> b) {
  double square = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double along = a[i] - b[i];
    square = std::fma(along, along, square);
  }
  return square;
}

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

CentreMatrix::CentreMatrix(Kernel kernel, std::size_t dimensions, double smoothing,
                           std::vector<std::size_t> base, std::span<const double> examples)
    : kernel_(kernel),
      dimensions_(dimensions),
      examples_(examples.size() / dimensions),
      smoothing_(kernel == Kernel::linear ? -smoothing : smoothing),
      base_(std::move(base)) {
  const std::size_t size = base_.size();
  const auto rows = static_cast<Eigen::Index>(size);
  Eigen::MatrixXd values(rows, rows);
  for (std::size_t a = 0; a < size; ++a) {
    const auto row = static_cast<Eigen::Index>(a);
    const auto place = examples.subspan(base_[a] * dimensions_, dimensions_);
    base_places_.insert(base_places_.end(), place.begin(), place.end());
    values(row, 0) = 1;
    for (std::size_t i = 0; i < dimensions_; ++i) {
      values(row, static_cast<Eigen::Index>(i) + 1) = place[i];
    }
  }
  if (size > 0) base_inverse_ = inverse_full_pivoting(values);
  for (std::size_t a = 0; a < size; ++a) {
    for (std::size_t b = 0; b < size; ++b) {
      const auto at = [&](std::size_t k) {
        return std::span<const double>(base_places_).subspan(k * dimensions_, dimensions_);
      };
      base_phi_.push_back(basis_scalar(kernel_, square_distance(at(a), at(b)), 1).value +
                          (a == b ? smoothing_ : 0));
    }
  }
}

void CentreMatrix::append(std::span<const double> place, double radius) {
  const std::size_t k = size();
  const double inverse_square = has_radii(kernel_) ? 1 / (radius * radius) : 1;
  for (std::size_t i = 0; i < k; ++i) {
    phi_here_.push_back(phi_between(place, i));
    phi_there_.push_back(
        basis_scalar(kernel_, square_distance(place, this->place(i)), inverse_square).value);
  }
  places_.insert(places_.end(), place.begin(), place.end());
  inverse_squares_.push_back(inverse_square);
  append_base_parts(place, planes_, to_base_);
  const std::size_t size = base_.size();
  for (std::size_t a = 0; a < size; ++a) {
    const auto within = std::span<const double>(base_phi_).subspan(a * size, size);
    beyond_base_.push_back(to_base_[k * size + a] - dot(within, planes(k)));
  }
}

void CentreMatrix::append_base_parts(std::span<const double> place, std::vector<double>& planes,
                                     std::vector<double>& to_base) const {
  for (std::size_t a = 0; a < base_.size(); ++a) {
    const auto column = static_cast<Eigen::Index>(a);
    double plane = base_inverse_(0, column);
    for (std::size_t i = 0; i < dimensions_; ++i) {
      plane += base_inverse_(static_cast<Eigen::Index>(i) + 1, column) * place[i];
    }
    planes.push_back(plane);
    const auto base_place =
        std::span<const double>(base_places_).subspan(a * dimensions_, dimensions_);
    to_base.push_back(basis_scalar(kernel_, square_distance(place, base_place), 1).value);
  }
}

void CentreMatrix::truncate(std::size_t centres) {
  places_.resize(centres * dimensions_);
  inverse_squares_.resize(centres);
  planes_.resize(centres * base_.size());
  to_base_.resize(centres * base_.size());
  beyond_base_.resize(centres * base_.size());
  phi_here_.resize(centres * (centres - 1) / 2);
  phi_there_.resize(centres * (centres - 1) / 2);
}

double CentreMatrix::nearest(std::span<const double> place) const {
  double square = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < size(); ++k) {
    square = std::min(square, square_distance(place, this->place(k)));
  }
  return std::sqrt(square);
}

double CentreMatrix::phi_between(std::span<const double> place, std::size_t k) const {
  return basis_scalar(kernel_, square_distance(place, this->place(k)), inverse_squares_[k]).value;
}

double CentreMatrix::phi(std::size_t i, std::size_t k) const {
  if (i == k) {
    const double here = basis_scalar(kernel_, 0, inverse_squares_[k]).value;
    return k < examples_ ? here + smoothing_ : here;
  }
  return i > k ? phi_here_[i * (i - 1) / 2 + k] : phi_there_[k * (k - 1) / 2 + i];
}

double CentreMatrix::kappa(std::size_t i, std::size_t k) const {
  const std::size_t size = base_.size();
  const auto row = [&](const std::vector<double>& values, std::size_t centre) {
    return std::span(values).subspan(centre * size, size);
  };
  return phi(i, k) - dot(row(planes_, i), row(beyond_base_, k)) -
         dot(row(planes_, k), row(to_base_, i));
}

void CentreMatrix::kappa_at(std::span<const double> place, std::span<const std::size_t> centres,
                            std::span<double> values) const {
  const std::size_t size = base_.size();
  std::vector<double> planes, to_base;
  append_base_parts(place, planes, to_base);
  for (std::size_t c = 0; c < centres.size(); ++c) {
    const std::size_t k = centres[c];
    values[c] = phi_between(place, k) -
                dot(planes, std::span(beyond_base_).subspan(k * size, size)) -
                dot(std::span(planes_).subspan(k * size, size), to_base);
  }
}

bool CentreMatrix::in_base(std::size_t k) const {
  return std::ranges::find(base_, k) != base_.end();
}

namespace {

// Four partial sums, so that additions do not wait for each other.
double dot(const double* a, const double* b, std::size_t count) {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    for (std::size_t lane = 0; lane < 4; ++lane) sums[lane] += a[i + lane] * b[i + lane];
  }
  for (std::size_t lane = 0; i < count; ++i, ++lane) sums[lane] += a[i] * b[i];
  return (sums[0] + sums[2]) + (sums[1] + sums[3]);
}

}  // namespace

bool BorderedFactors::append(std::span<const double> row, std::span<const double> column,
                             double corner, double least) {
  const std::size_t begin = size_ * (size_ + 1) / 2;
  lower_.resize(begin + size_ + 1);
  upper_.resize(begin + size_ + 1);
  double* l = lower_.data() + begin;
  double* u = upper_.data() + begin;
  for (std::size_t k = 0; k < size_; ++k) {
    const double* above = lower_.data() + k * (k + 1) / 2;
    const double* before = upper_.data() + k * (k + 1) / 2;
    u[k] = column[k] - dot(above, u, k);
    l[k] = (row[k] - dot(before, l, k)) / before[k];
    corner -= l[k] * u[k];
  }
  if (!(std::abs(corner) >= least) || !std::isfinite(corner)) return false;
  l[size_] = 1;
  u[size_] = corner;
  ++size_;
  return true;
}

void BorderedFactors::solve_lower(std::span<double> values, std::size_t columns,
                                  std::size_t first) const {
  for (std::size_t k = first; k < size_; ++k) {
    double* to = values.data() + k * columns;
    for (std::size_t i = 0; i < k; ++i) {
      const double factor = lower(k, i);
      const double* from = values.data() + i * columns;
      for (std::size_t j = 0; j < columns; ++j) to[j] -= factor * from[j];
    }
  }
}

void BorderedFactors::solve_upper(std::span<double> values, std::size_t columns) const {
  for (std::size_t k = size_; k-- > 0;) {
    double* from = values.data() + k * columns;
    const double pivot = upper(k, k);
    for (std::size_t j = 0; j < columns; ++j) from[j] /= pivot;
    for (std::size_t i = 0; i < k; ++i) {
      const double factor = upper(i, k);
      double* to = values.data() + i * columns;
      for (std::size_t j = 0; j < columns; ++j) to[j] -= factor * from[j];
    }
  }
}

void BorderedFactors::solve_transposed(std::span<double> values) const {
  for (std::size_t k = 0; k < size_; ++k) {
    for (std::size_t i = 0; i < k; ++i) values[k] -= upper(i, k) * values[i];
    values[k] /= upper(k, k);
  }
  for (std::size_t k = size_; k-- > 0;) {
    for (std::size_t i = 0; i < k; ++i) values[i] -= lower(k, i) * values[k];
  }
}

}  // namespace krok::rbf::detail
