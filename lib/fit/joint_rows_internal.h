#pragma once

#include <cstddef>
#include <vector>

namespace krok::fit::detail {

// How blends at points depend on the rows of inserted points, about the rows that they have.
struct JointRows {
  std::size_t points = 0, dimensions = 0, rows = 0, examples = 0;
  std::vector<double> influences;  // [points x rows]: what is added to a row counts so much
  std::vector<double> weights;     // [points x examples], without changes
  std::vector<double> errors;      // [points x d], scaled
  std::vector<double> slopes;      // [points x d x examples], of the errors by each weight
};

struct JointTerms {
  double stay = 0;      // lambda
  double positive = 0;  // mu
  double low = 0;       // which weights cost something
  int iterations = 0;   // at most
};

// What is best added to the rows, [rows x examples], each of sum 0: the least of what polish.h
// says, by Ceres. The same with any number of jobs. All 0 where there is nothing to gain.
std::vector<double> joint_changes(const JointRows& problem, const JointTerms& terms, int jobs);

}  // namespace krok::fit::detail
