#pragma once

#include <cstddef>
#include <span>
#include <vector>

// The factors A = L U, L with ones on its diagonal, of a matrix that grows by a row and a column at
// a time, without exchange of rows. Every number is made by the same operations in the same order
// however the matrix came to its size.

namespace krok::rbf::detail {

class BorderedFactors {
 public:
  std::size_t size() const { return size_; }

  // Adds the row (row, corner) and the column (column, corner), both [size()]. False, and nothing
  // is changed, where the new diagonal element of U is under `least` or no number: A would be
  // (almost) singular.
  bool append(std::span<const double> row, std::span<const double> column, double corner,
              double least);

  // Back to the first `size` rows and columns.
  void truncate(std::size_t size) { size_ = size; }

  // X = L^-1 B for the rows from `first` on, B and X [size() x columns] in the same place; the rows
  // before are solved already.
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
  // Row after row of L, column after column of U, each up to the diagonal: what is appended stands
  // at the end.
  std::vector<double> lower_, upper_;
};

}  // namespace krok::rbf::detail
