#pragma once

#include <span>
#include <vector>

namespace krok::ik {

// (sum of w c c^T + damping I) y = e: the normal equations of damped least squares over goals' rows
// instead of joints, which are fewer. Columns c have entries in a range of rows alone.
class NormalEquations {
 public:
  void reset(int rows);

  // Adds w c c^T for a column with entries in [first, last); w < 0 takes one out again.
  void add(double w, const double* column, int first, int last);

  // y for the right side `e`, both [rows] and different memory. Destroys nothing: more columns may
  // be added or taken out later.
  void solve(double damping, const double* e, double* y);

 private:
  std::size_t rows_ = 0;
  std::vector<double> upper_;   // [rows x rows], the upper triangle
  std::vector<double> factor_;  // scratch
};

}  // namespace krok::ik
