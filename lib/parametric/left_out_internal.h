#pragma once

#include <optional>
#include <span>
#include <vector>

#include "parametric/bounds.h"
#include "parametric/library.h"
#include "parametric/packed_examples.h"
#include "rbf/weight_solver.h"

// What leaving examples out and trying weights share: simple weights to compare with, and the
// distance between a blend and an example.

namespace krok::parametric::detail {

// The parameters of all examples, [examples x d].
std::vector<double> parameters_of(const Library& library);

// The unrefined weight function of the examples. Codes: those of WeightSolver::create().
Result<rbf::WeightFunction> weights_of(const Library& library, rbf::Kernel kernel,
                                       double smoothing);

// Values of the least-squares affine fit of the examples' weights at a point, [examples].
std::vector<double> plane_weights(const Bounds& bounds, std::span<const double> point);

// 1 for the example with the nearest parameters, scaled by their ranges.
std::vector<double> nearest_weights(const Bounds& bounds, std::span<const double> point);

// Positions of an example's joints at fixed fractions of its intervals, [samples x joints], without
// the joints above the hips.
std::vector<Vec3> example_poses(const Library& library, std::size_t index);
// The number of those samples.
std::size_t samples_of(const Library& library);

// RMS distance over joints and samples between the blend with these weights and such positions,
// metres; nullopt if there is no such blend.
std::optional<double> distance(const Library& library, const PackedExamples& packed,
                               std::span<const double> weights, const std::vector<Vec3>& wanted);

}  // namespace krok::parametric::detail
