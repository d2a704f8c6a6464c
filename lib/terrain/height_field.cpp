#include "terrain/height_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace krok::terrain {

namespace {

class Field final : public Terrain {
 public:
  explicit Field(HeightField field)
      : field_(std::move(field)),
        columns_per_metre_((field_.columns - 1) / field_.width),
        rows_per_metre_((field_.rows - 1) / field_.depth) {}

  std::optional<GroundPoint> at(double x, double z, double below) const override {
    const double u = (x - field_.centre_x + field_.width / 2) * columns_per_metre_;
    const double v = (z - field_.centre_z + field_.depth / 2) * rows_per_metre_;
    if (!(u >= 0 && u <= field_.columns - 1 && v >= 0 && v <= field_.rows - 1)) {
      return std::nullopt;
    }
    const int column = std::min(static_cast<int>(u), field_.columns - 2);
    const int row = std::min(static_cast<int>(v), field_.rows - 2);
    const double right = u - column, down = v - row;
    const double a = sample(column, row), b = sample(column + 1, row);
    const double c = sample(column, row + 1), d = sample(column + 1, row + 1);
    const double upper = a + (b - a) * right, lower = c + (d - c) * right;
    const double height = upper + (lower - upper) * down;
    // Also false for NaN, that is in a hole.
    if (!(height <= below)) return std::nullopt;
    const double along_x = ((b - a) * (1 - down) + (d - c) * down) * columns_per_metre_;
    const double along_z = (lower - upper) * rows_per_metre_;
    return GroundPoint{height, Vec3(-along_x, 1, -along_z).normalized()};
  }

 private:
  double sample(int column, int row) const {
    return field_.heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(field_.columns) +
                          static_cast<std::size_t>(column)];
  }

  HeightField field_;
  double columns_per_metre_;
  double rows_per_metre_;
};

}  // namespace

Result<std::unique_ptr<Terrain>> height_field(HeightField field) {
  if (field.columns < 2 || field.rows < 2) {
    return Error(
        "ground-size",
        fmt::format("a height field of {} x {} samples has no area", field.columns, field.rows),
        "use at least 2 x 2");
  }
  const std::int64_t samples = std::int64_t{field.columns} * field.rows;
  if (samples > kMaxHeights) {
    return Error(
        "ground-size",
        fmt::format("{} x {} samples are more than {}", field.columns, field.rows, kMaxHeights),
        "scale the image down");
  }
  if (static_cast<std::int64_t>(field.heights.size()) != samples) {
    return Error("ground-size",
                 fmt::format("{} heights for {} samples", field.heights.size(), samples));
  }
  const auto is_size = [](double metres) { return metres >= 1e-3 && metres <= 1e6; };
  if (!is_size(field.width) || !is_size(field.depth)) {
    return Error("ground-size",
                 fmt::format("a height field cannot measure {} x {} m", field.width, field.depth),
                 "use sides from 1 mm to 1000 km");
  }
  if (!std::isfinite(field.centre_x) || !std::isfinite(field.centre_z)) {
    return Error("ground-value", "the centre of the height field is not finite");
  }
  bool any = false;
  for (std::size_t i = 0; i < field.heights.size(); ++i) {
    if (std::isinf(field.heights[i])) {
      return Error("ground-value",
                   fmt::format("the height in column {}, row {} is infinite",
                               i % static_cast<std::size_t>(field.columns),
                               i / static_cast<std::size_t>(field.columns)),
                   "use NaN for holes");
    }
    any = any || !std::isnan(field.heights[i]);
  }
  if (!any) return Error("ground-empty", "all heights of the height field are holes (NaN)");
  return std::unique_ptr<Terrain>(std::make_unique<Field>(std::move(field)));
}

}  // namespace krok::terrain
