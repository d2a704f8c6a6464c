#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "rbf/weight_function.h"

// Kernel values between all centres, and the matrix left to solve once the affine part is
// eliminated.

namespace krok::rbf::detail {

// Kernels that need an affine part in their system (cubic, linear) set d + 1 examples apart, the
// base. The Lagrange functions l_a (affine, 1 at one base point and 0 at the others) project each
// kernel to one that vanishes at the base,
//
//   kappa(x, y) = phi(x, y) - sum_a l_a(x) phi(x_a, y) - sum_b l_b(y) phi(x, x_b)
//                 + sum_ab l_a(x) l_b(y) phi(x_a, x_b).
//
// The matrix of kappa over all other centres is definite (Wendland: Scattered Data Approximation,
// 2005, ch. 10.3); the usual saddle-point matrix is neither definite nor easy to extend. For other
// kernels the base is empty and kappa = phi.
//
// Smoothing is added to phi of each example at its own position (subtracted for linear, whose phi
// is conditionally negative definite), so that no other code has to handle it.
class CentreMatrix {
 public:
  // `base`: indices of examples, empty for kernels without an affine part. `examples`: [examples x
  // d], scaled.
  CentreMatrix(Kernel kernel, std::size_t dimensions, double smoothing,
               std::vector<std::size_t> base, std::span<const double> examples);

  // Adds a centre; examples first. `radius` is ignored for kernels without one.
  void append(std::span<const double> place, double radius);
  void truncate(std::size_t centres);

  std::size_t size() const { return inverse_squares_.size(); }
  std::span<const double> place(std::size_t k) const {
    return std::span(places_).subspan(k * dimensions_, dimensions_);
  }
  // Distance from `place` to the nearest centre; infinity if there is none.
  double nearest(std::span<const double> place) const;

  // phi of centre k at the position of centre i, with smoothing.
  double phi(std::size_t i, std::size_t k) const;
  // The Lagrange functions of the base at centre i, [base].
  std::span<const double> planes(std::size_t i) const {
    return std::span(planes_).subspan(i * base_.size(), base_.size());
  }
  // kappa of centre k at the position of centre i; neither may be in the base.
  double kappa(std::size_t i, std::size_t k) const;
  // kappa of each of `centres` (none in the base) at any position, without smoothing.
  void kappa_at(std::span<const double> place, std::span<const std::size_t> centres,
                std::span<double> values) const;

  const std::vector<std::size_t>& base() const { return base_; }
  bool in_base(std::size_t k) const;
  // [(d + 1) x base]: maps values at the base to affine coefficients of (1, q).
  const Eigen::MatrixXd& base_inverse() const { return base_inverse_; }

 private:
  double phi_between(std::span<const double> place, std::size_t k) const;
  // Appends the Lagrange functions of the base at a position, and phi between it and each base
  // point.
  void append_base_parts(std::span<const double> place, std::vector<double>& planes,
                         std::vector<double>& to_base) const;

  Kernel kernel_;
  std::size_t dimensions_, examples_;
  double smoothing_;  // signed
  std::vector<std::size_t> base_;
  Eigen::MatrixXd base_inverse_;
  std::vector<double> base_places_, base_phi_;  // [base x d], [base x base]
  std::vector<double> places_, inverse_squares_;
  // [centres x base]: Lagrange functions; phi between the centre and each base point; the latter
  // minus its part within the base.
  std::vector<double> planes_, to_base_, beyond_base_;
  // Rows up to the diagonal: phi of earlier centres at this one, and of this one at earlier ones.
  std::vector<double> phi_here_, phi_there_;
};

// LU factors A = L U (unit diagonal in L, no pivoting) of a matrix that grows by one row and column
// at a time. Each element is computed by the same operations in the same order, however the matrix
// reached its size.

class BorderedFactors {
 public:
  std::size_t size() const { return size_; }

  // Appends the row (row, corner) and the column (column, corner), both [size()]. Returns false and
  // changes nothing if the new diagonal element of U is below `least` or NaN: A would be (almost)
  // singular.
  bool append(std::span<const double> row, std::span<const double> column, double corner,
              double least);

  // Keeps the first `size` rows and columns.
  void truncate(std::size_t size) { size_ = size; }

  // X = L^-1 B from row `first` on, in place; B and X are [size() x columns]. Earlier rows must be
  // solved already.
  void solve_lower(std::span<double> values, std::size_t columns, std::size_t first = 0) const;
  // X = U^-1 B.
  void solve_upper(std::span<double> values, std::size_t columns) const;
  // x = A^-T b.
  void solve_transposed(std::span<double> values) const;

 private:
  double lower(std::size_t row, std::size_t column) const {
    return lower_[row * (row + 1) / 2 + column];
  }
  double upper(std::size_t row, std::size_t column) const {
    return upper_[column * (column + 1) / 2 + row];
  }

  std::size_t size_ = 0;
  // L by rows and U by columns, each up to the diagonal, so that appending adds to the end.
  std::vector<double> lower_, upper_;
};

}  // namespace krok::rbf::detail
