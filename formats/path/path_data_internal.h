#pragma once

#include <Eigen/Geometry>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "math/types.h"

// Private to this folder: points of SVG path data.

namespace krok::path_file {

inline constexpr std::size_t kMaxPoints = 4'000'000;

using Affine2 = Eigen::Transform<double, 2, Eigen::Affine>;

// What is wrong, and the byte of the text where it is.
struct DataFault {
  std::size_t offset = 0;
  std::string message;
  std::string code = "path-data";
};

// Appends the points of path data; `to_metres` goes from the file's units to x and z. One subpath.
// Empty if it succeeds. Source: W3C, SVG 2, sections 9.3 and B.2 (elliptical arcs).
std::optional<DataFault> read_path_data(std::string_view data, const Affine2& to_metres,
                                        std::vector<Vec2>& points);

// The same for the points of a polyline.
std::optional<DataFault> read_polyline(std::string_view data, const Affine2& to_metres,
                                       std::vector<Vec2>& points);

// A transform attribute: translate, scale, rotate, skewX, skewY, matrix. Source: W3C, CSS
// Transforms Module Level 1, section 8.
std::optional<DataFault> read_transform(std::string_view text, Affine2& transform);

// The way that an SVG document draws. `fault_place` is the byte where an Error belongs.
Result<std::vector<Vec2>> read_svg(std::string_view text, double metres_per_unit,
                                   const std::string& id, std::size_t& fault_place);

}  // namespace krok::path_file
