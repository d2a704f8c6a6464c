#pragma once

#include <cstddef>
#include <vector>

namespace krok::fit::detail {

// Adds `count` rows of n numbers, each times a factor, to `to`; `stride`: distance between factors.
// SIMD, bit-identical on all instruction sets.
void add_products(const double* factors, std::size_t stride, const double* rows, std::size_t count,
                  std::size_t n, double* to);

// Linear model of how blends at points depend on changes of the rows of inserted points.
struct JointRows {
  std::size_t points = 0, dimensions = 0, rows = 0, examples = 0;
  std::vector<double> influences;  // [points x rows], effect of a change of a row
  std::vector<double> weights;     // [points x examples], with unchanged rows
  std::vector<double> errors;      // [points x d], scaled
  std::vector<double> slopes;      // [points x d x examples], of the errors by the weights
};

struct JointTerms {
  double stay = 0;      // lambda
  double positive = 0;  // mu
  double low = 0;       // weights below it are penalised
  int iterations = 0;   // max
};

// The changes of the rows, [rows x examples], each with sum 0, that minimise the cost in polish.h,
// by Ceres. Independent of the number of jobs. All 0 if nothing improves.
std::vector<double> joint_changes(const JointRows& problem, const JointTerms& terms, int jobs);

}  // namespace krok::fit::detail
