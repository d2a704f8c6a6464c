#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/result.h"

// Maps parameters to blend weights. Each of N examples has d parameters (for a step: length, width,
// turn) and a weight function w_i(p) that is 1 at its own parameters and 0 at those of the other
// examples (cardinal basis: Rose, Cohen, Bodenheimer: Verbs and Adverbs, 1998). Each is an affine
// part plus radial basis functions:
//
//     w_i(p) = affine_i . (1, q) + sum_k coefficient_ki phi(|q - q_k| / radius_k),
//
// where q = (p - lower) / (upper - lower) are the parameters scaled by their ranges, and q_k are
// the centres: the examples, then inserted points with given weights. The weights sum to 1 for
// every p; without inserted points, sum_i w_i(p) p_i = p.
//
// Examples with similar parameters but different motions force large weights of opposite sign
// between them. Smoothing lets the weights miss the examples: for cubic and linear, the function
// minimises the sum of |w(p_i) - e_i|^2 plus smoothing times its roughness (smoothing spline:
// Wahba, Spline models for observational data, 1990). Both sums above still hold.

namespace krok::rbf {

inline constexpr int kMaxDimensions = 8;
inline constexpr int kMaxExamples = 1024;
inline constexpr int kMaxCentres = 4096;

// Whether a point lies in the region that the examples cover; if empty, every point of the range
// does. Captured examples rarely fill the box of their ranges: steps are long in a run and short in
// a stroll.
using Inside = std::function<bool(std::span<const double> point)>;

// phi by t = |q - q_k| / radius. Where a radius is used, it is a multiple (below) of the distance
// to the nearest other centre when the centre was added; later centres do not change it.
enum class Kernel : unsigned char {
  cubic,     // t^3, radius 1; with the affine part, the natural cubic spline in 1D
  linear,    // t, radius 1; the smallest overshoot, but slopes jump at the centres
  gaussian,  // exp(-4 t^2), 1/e at the nearest other centre; radius: twice the distance
  bspline,   // cubic B-spline with support t < 1, scaled to 1 at t = 0; radius: twice the distance
  wendland   // (1 - t)^4 (4 t + 1) (Wendland 1995), support t < 1; radius: four times the distance
};

// "cubic", "linear", ...
std::string_view kernel_name(Kernel kernel);
std::optional<Kernel> kernel_named(std::string_view name);

bool has_radii(Kernel kernel);

// Everything that evaluation and further insertion need, as plain numbers. Writing to a file and
// reading back preserves every bit. Made by weight_solver.h, evaluated by weight_evaluator.h.
struct WeightFunction {
  Kernel kernel = Kernel::cubic;
  int dimensions = 0;                // d, 1 to kMaxDimensions
  int examples = 0;                  // N, at least d + 1
  std::vector<double> lower, upper;  // [d], the range of each parameter, in its unit
  std::vector<double> centres;  // [centres x d], in parameter units; the first N are the examples
  std::vector<double> radii;    // [centres], scaled; empty for cubic and linear
  // 0: interpolates the examples; larger values approach affine functions. Inserted points are
  // always interpolated.
  double smoothing = 0;
  std::vector<double> inserted_rows;  // [inserted x N], weights given at the inserted points
  std::vector<double> affine;         // [(d + 1) x N], coefficients of (1, q)
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
  // Scales p to q, which is in [0, 1] within the range. Both are [d].
  void scale(std::span<const double> point, std::span<double> scaled) const;

  // Whether the data is consistent. Codes: rbf-kernel; rbf-dimensions, rbf-examples, rbf-centres
  // for counts; rbf-bounds; rbf-radius; rbf-shape if an array has the wrong length; rbf-number for
  // a number that is not finite, or negative smoothing; rbf-sum if the weights would not sum to 1.
  Status check() const;

  bool operator==(const WeightFunction&) const = default;
};

// Quality metrics of weight functions over the range of their parameters.

struct WeightMetrics {
  double least = 0, largest = 0;  // over all weights
  // Mean over the range of sum_i |H_i|^2 (Frobenius), where H_i is the Hessian of weight i by
  // scaled parameters, as in thin-plate bending energy. From finite differences of slopes, a
  // fiftieth of the range apart, because the linear kernel has no finite Hessian at its centres.
  double roughness = 0;
  double sum_error = 0;  // max |sum of weights - 1|
};

// Sampled at `points` points of the Sobol sequence; least and largest include the centres. Codes:
// those of WeightFunction::check().
Result<WeightMetrics> weight_metrics(const WeightFunction& function, int points = 256,
                                     const Inside& inside = {});

}  // namespace krok::rbf
