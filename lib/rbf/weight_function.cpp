#include "rbf/weight_function.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/numbers.h"
#include "rbf/weight_system_internal.h"

namespace krok::rbf {

namespace {

constexpr std::string_view kNames[] = {"cubic", "linear", "gaussian", "bspline", "wendland"};

// Max error of the sums of a file's numbers, relative to the largest number.
constexpr double kSumTolerance = 1e-9;

// Whether each row of `columns` numbers has the right sum: `first` for row 0, else `others`.
bool sums_are(std::span<const double> rows, std::size_t columns, double first, double others) {
  for (std::size_t r = 0; r * columns < rows.size(); ++r) {
    double sum = 0, largest = 1;
    for (const double value : rows.subspan(r * columns, columns)) {
      sum += value;
      largest = std::max(largest, std::abs(value));
    }
    if (!(std::abs(sum - (r == 0 ? first : others)) <= kSumTolerance * largest)) return false;
  }
  return true;
}

Status check_counts(const WeightFunction& f) {
  if (static_cast<std::size_t>(f.kernel) >= std::size(kNames)) {
    return Error("rbf-kernel", "unknown kernel");
  }
  if (f.dimensions < 1 || f.dimensions > kMaxDimensions) {
    return Error("rbf-dimensions",
                 fmt::format("a weight function cannot have {} parameters", f.dimensions),
                 fmt::format("1 to {} are allowed", kMaxDimensions));
  }
  if (f.examples < f.dimensions + 1 || f.examples > kMaxExamples) {
    return Error(
        "rbf-examples",
        fmt::format("a weight function cannot have {} examples for {} parameters", f.examples,
                    f.dimensions),
        fmt::format("at least one more than parameters, and at most {}, are needed", kMaxExamples));
  }
  const auto d = static_cast<std::size_t>(f.dimensions);
  if (f.centres.size() % d != 0 || f.centres.size() / d < static_cast<std::size_t>(f.examples) ||
      f.centres.size() / d > kMaxCentres) {
    return Error(
        "rbf-centres",
        fmt::format("invalid centres: {} numbers for {} examples with {} parameters",
                    f.centres.size(), f.examples, f.dimensions),
        fmt::format("each example is a centre; at most {} centres are allowed", kMaxCentres));
  }
  return {};
}

Status check_shapes(const WeightFunction& f) {
  const auto d = static_cast<std::size_t>(f.dimensions);
  const auto n = static_cast<std::size_t>(f.examples);
  const auto centres = static_cast<std::size_t>(f.centre_count());
  const struct {
    const char* name;
    std::span<const double> values;
    std::size_t size;
  } arrays[] = {{"lower bounds", f.lower, d},
                {"upper bounds", f.upper, d},
                {"centres", f.centres, centres * d},
                {"radii", f.radii, has_radii(f.kernel) ? centres : 0},
                {"rows of inserted points", f.inserted_rows, (centres - n) * n},
                {"affine coefficients", f.affine, (d + 1) * n},
                {"coefficients", f.coefficients, centres * n}};
  for (const auto& array : arrays) {
    if (array.values.size() != array.size) {
      return Error("rbf-shape",
                   fmt::format("a weight function has {} numbers in its {}, expected {}",
                               array.values.size(), array.name, array.size));
    }
    if (!detail::all_finite(array.values)) {
      return Error("rbf-number",
                   fmt::format("the {} of a weight function contain NaN or infinity", array.name));
    }
  }
  return {};
}

}  // namespace

std::string_view kernel_name(Kernel kernel) {
  return kNames[static_cast<std::size_t>(kernel)];
}

std::optional<Kernel> kernel_named(std::string_view name) {
  const auto at = std::ranges::find(kNames, name);
  if (at == std::end(kNames)) return {};
  return static_cast<Kernel>(at - std::begin(kNames));
}

bool has_radii(Kernel kernel) {
  return kernel != Kernel::cubic && kernel != Kernel::linear;
}

void WeightFunction::scale(std::span<const double> point, std::span<double> scaled) const {
  for (std::size_t i = 0; i < lower.size(); ++i) {
    scaled[i] = (point[i] - lower[i]) * (1 / (upper[i] - lower[i]));
  }
}

Status WeightFunction::check() const {
  if (Status status = check_counts(*this); !status) return status;
  if (Status status = check_shapes(*this); !status) return status;
  for (std::size_t i = 0; i < lower.size(); ++i) {
    if (!(upper[i] > lower[i]) || !std::isfinite(1 / (upper[i] - lower[i])) ||
        !std::isfinite(upper[i] - lower[i])) {
      return Error("rbf-bounds",
                   fmt::format("invalid range of parameter {}: {} to {}", i + 1, readable(lower[i]),
                               readable(upper[i])),
                   "leave out parameters that are the same in all examples");
    }
  }
  for (const double radius : radii) {
    if (!(radius > 0) || !std::isfinite(1 / (radius * radius))) {
      return Error("rbf-radius", fmt::format("invalid radius {} of a centre", readable(radius)));
    }
  }
  if (!(smoothing >= 0) || !std::isfinite(smoothing)) {
    return Error("rbf-number", fmt::format("invalid smoothing {}", readable(smoothing)),
                 "it must be 0 or more");
  }
  const auto n = static_cast<std::size_t>(examples);
  if (!sums_are(affine, n, 1, 0) || !sums_are(coefficients, n, 0, 0) ||
      !sums_are(inserted_rows, n, 1, 1)) {
    return Error("rbf-sum", "the weights of a weight function do not sum to 1");
  }
  return {};
}

}  // namespace krok::rbf
