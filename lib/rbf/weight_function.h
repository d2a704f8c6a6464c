#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/result.h"

// From parameters to weights: each of N examples has d parameters (a step: its length, width, turn)
// and a weight function w_i(p) that is 1 at its own parameters and 0 at those of the others
// (cardinal functions: Rose, Cohen, Bodenheimer: Verbs and Adverbs, 1998). Each is a plane plus a
// radial correction,
//
//     w_i(p) = affine_i . (1, q) + sum_k coefficient_ki phi(|q - q_k| / radius_k),
//
// where q = (p - lower) / (upper - lower) are the parameters scaled by their ranges and q_k are
// centres: the examples, then points that were inserted with weights given for them. The weights
// sum to 1 for every p, and without inserted points sum_i w_i(p) p_i = p.
//
// Examples that measure alike and look different cannot all be met without weights of large and
// opposite signs between them. Smoothing lets weights miss them: for cubic and linear the function
// has the least sum of |w(p_i) - e_i|^2 and smoothing times its roughness (a smoothing spline:
// Wahba, Spline models for observational data, 1990), and both sums above still hold.

namespace krok::rbf {

inline constexpr int kMaxDimensions = 8;
inline constexpr int kMaxExamples = 1024;
inline constexpr int kMaxCentres = 4096;

// Tells points of which anything is known from others; empty, all within the range count. Examples
// of captures rarely fill the box of their ranges: long steps at a run, short ones at a stroll.
using Inside = std::function<bool(std::span<const double> point)>;

// phi by t = |q - q_k| / radius. Those with a radius have it from the distance to the nearest other
// centre at the time when the centre came in; it stays when more come.
enum class Kernel : unsigned char {
  cubic,     // t^3, radius 1; with the plane it is the surface of least bending in one dimension
  linear,    // t, radius 1: the mildest weights; their slopes jump at the centres
  gaussian,  // exp(-4 t^2), 1/e at the nearest other centre; twice the distance
  bspline,   // cubic B-spline that ends at t = 1, scaled to 1 at t = 0; twice the distance
  wendland   // (1 - t)^4 (4 t + 1) (Wendland 1995), ends at t = 1; four times the distance
};

// "cubic", "linear", ...
std::string_view kernel_name(Kernel kernel);
std::optional<Kernel> kernel_named(std::string_view name);

bool has_radii(Kernel kernel);

// All that evaluation and further insertion need, as plain numbers: what is written to a file and
// read back gives the same bits (see weight_evaluator.h; made by weight_solver.h).
struct WeightFunction {
  Kernel kernel = Kernel::cubic;
  int dimensions = 0;                // d, 1 to kMostDimensions
  int examples = 0;                  // N, d + 1 at least
  std::vector<double> lower, upper;  // [d], the range of each parameter in its own unit
  std::vector<double> centres;       // [centres x d], own units; the examples are the first N
  std::vector<double> radii;         // [centres], in scaled parameters; empty for cubic, linear
  // 0: examples are met; the more, the nearer to planes through all. Inserted points are met.
  double smoothing = 0;
  std::vector<double> inserted_rows;  // [inserted x N], the weights given at inserted points
  std::vector<double> affine;         // [(d + 1) x N], by (1, q)
  std::vector<double> coefficients;   // [centres x N]

  int centre_count() const {
    return dimensions > 0 ? static_cast<int>(centres.size()) / dimensions : 0;
  }
  int inserted() const { return centre_count() - examples; }
  std::span<const double> centre(int k) const {
    const auto d = static_cast<std::size_t>(dimensions);
    return std::span(centres).subspan(static_cast<std::size_t>(k) * d, d);
  }
  std::span<const double> inserted_row(int k) const {
    const auto n = static_cast<std::size_t>(examples);
    return std::span(inserted_rows).subspan(static_cast<std::size_t>(k) * n, n);
  }
  // p scaled: q in [0, 1] within the range. Both [d].
  void scale(std::span<const double> point, std::span<double> scaled) const;

  // Whether the numbers belong together. Codes: rbf-dimensions, rbf-examples, rbf-centres for
  // counts; rbf-bounds; rbf-radius; rbf-shape where an array has another length; rbf-number for
  // what is not finite, or a smoothing below 0; rbf-sum where the weights would not sum to 1.
  Status check() const;

  bool operator==(const WeightFunction&) const = default;
};

}  // namespace krok::rbf
