#pragma once

#include <cstddef>
#include <span>
#include <vector>

// LU factors A = L U (unit diagonal in L, no pivoting) of a matrix that grows by one row and column
// at a time. Each element is computed by the same operations in the same order, however the matrix
// reached its size.

namespace krok::rbf::detail {

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
