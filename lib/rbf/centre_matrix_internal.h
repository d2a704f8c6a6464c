#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "rbf/weight_function.h"

// The kernels of all centres at all centres, and the matrix that remains to be solved when the
// planes are taken care of.

namespace krok::rbf::detail {

// For kernels that need planes in their system (cubic, linear) d + 1 examples, the base, are set
// apart. Planes l_a that are 1 at one of them and 0 at the others take what is 0 at the base out of
// every kernel,
//
//   kappa(x, y) = phi(x, y) - sum_a l_a(x) phi(x_a, y) - sum_b l_b(y) phi(x, x_b)
//                 + sum_ab l_a(x) l_b(y) phi(x_a, x_b),
//
// and the matrix of kappa over all other centres is definite (Wendland: Scattered Data
// Approximation, 2005, ch. 10.3), where the usual saddle matrix with planes is neither definite nor
// easily extended. With other kernels the base is empty and kappa = phi.
//
// Smoothing is added to phi of each example at its own place (taken off for linear, whose phi is
// negative on what is orthogonal to planes), so that the rest need not know of it.
class CentreMatrix {
 public:
  // The base of examples, [examples x d] scaled: indices. Empty for kernels without planes.
  CentreMatrix(Kernel kernel, std::size_t dimensions, double smoothing,
               std::vector<std::size_t> base, std::span<const double> examples);

  // A new centre; examples first. `radius` is not read for kernels without.
  void append(std::span<const double> place, double radius);
  void truncate(std::size_t centres);

  std::size_t size() const { return inverse_squares_.size(); }
  std::span<const double> place(std::size_t k) const {
    return std::span(places_).subspan(k * dimensions_, dimensions_);
  }
  // The distance from `place` to the nearest centre; infinite if there is none.
  double nearest(std::span<const double> place) const;

  // phi of centre k at the place of centre i, with the smoothing.
  double phi(std::size_t i, std::size_t k) const;
  // The planes of the base at centre i, [base].
  std::span<const double> planes(std::size_t i) const {
    return std::span(planes_).subspan(i * base_.size(), base_.size());
  }
  // kappa of centre k at the place of centre i; neither is of the base.
  double kappa(std::size_t i, std::size_t k) const;
  // kappa of each of `centres`, none of the base, at any place; no centre's smoothing counts there.
  void kappa_at(std::span<const double> place, std::span<const std::size_t> centres,
                std::span<double> values) const;

  const std::vector<std::size_t>& base() const { return base_; }
  bool in_base(std::size_t k) const;
  // [(d + 1) x base]: the plane through values at the base, by (1, q).
  const Eigen::MatrixXd& base_inverse() const { return base_inverse_; }

 private:
  double phi_between(std::span<const double> place, std::size_t k) const;
  // Appends the planes of the base at a place, and phi between it and each of the base.
  void append_base_parts(std::span<const double> place, std::vector<double>& planes,
                         std::vector<double>& to_base) const;

  Kernel kernel_;
  std::size_t dimensions_, examples_;
  double smoothing_;  // with its sign
  std::vector<std::size_t> base_;
  Eigen::MatrixXd base_inverse_;
  std::vector<double> base_places_, base_phi_;  // [base x d], [base x base]
  std::vector<double> places_, inverse_squares_;
  // [centres x base]: the planes, phi of the centre with each of the base, and that less its part
  // within the base.
  std::vector<double> planes_, to_base_, beyond_base_;
  // Row after row up to the diagonal, phi of earlier centres here and of this one there.
  std::vector<double> phi_here_, phi_there_;
};

}  // namespace krok::rbf::detail
