#include "terrain/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace krok::terrain {

namespace {

constexpr double kFlatRadius = 0.3;
constexpr double kFullRadius = 1.0;
constexpr double kFarthestNoise = 1e9;

struct Lattice {
  double spacing;
  double share;
};
constexpr std::array kLattices = {Lattice{0.6, 0.75}, Lattice{0.2, 0.25}};

// A value and how it changes along x and z.
struct Slanted {
  double value = 0;
  double along_x = 0, along_z = 0;
};

// Mixes the bits of a number (splitmix64: Steele, Lea, Flood 2014, "Fast splittable pseudorandom
// number generators").
std::uint64_t mixed(std::uint64_t bits) {
  bits += 0x9E3779B97F4A7C15u;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
  return bits ^ (bits >> 31);
}

struct Eased {
  double value, slope;
};
Eased eased(double t) {
  return {t * t * t * (t * (6 * t - 15) + 10), 30 * t * t * (t - 1) * (t - 1)};
}

class Rough final : public Terrain {
 public:
  explicit Rough(const RoughOptions& options) : options_(options) {}

  std::optional<GroundPoint> at(double x, double z, double below) const override {
    if (!(std::abs(x) < kFarthestNoise && std::abs(z) < kFarthestNoise)) return std::nullopt;
    Slanted sum;
    for (std::size_t i = 0; i < kLattices.size(); ++i) {
      const Slanted one = noise(i, x, z);
      sum.value += kLattices[i].share * one.value;
      sum.along_x += kLattices[i].share * one.along_x;
      sum.along_z += kLattices[i].share * one.along_z;
    }
    const Slanted ground = flattened(sum, x, z);
    const double height = options_.height * ground.value;
    if (!(height <= below)) return std::nullopt;
    const Vec3 normal(-options_.height * ground.along_x, 1, -options_.height * ground.along_z);
    return GroundPoint{height, normal.normalized()};
  }

 private:
  // From -0.5 to 0.5.
  double corner(std::size_t lattice, std::int64_t column, std::int64_t row) const {
    const std::uint64_t bits =
        mixed(mixed(mixed(options_.seed + lattice) ^ static_cast<std::uint64_t>(column)) ^
              static_cast<std::uint64_t>(row));
    return static_cast<double>(bits >> 11) * 0x1p-53 - 0.5;
  }

  Slanted noise(std::size_t lattice, double x, double z) const {
    const double spacing = kLattices[lattice].spacing;
    const double u = x / spacing, v = z / spacing;
    const auto column = static_cast<std::int64_t>(std::floor(u));
    const auto row = static_cast<std::int64_t>(std::floor(v));
    const Eased right = eased(u - std::floor(u)), down = eased(v - std::floor(v));
    const double a = corner(lattice, column, row), b = corner(lattice, column + 1, row);
    const double c = corner(lattice, column, row + 1), d = corner(lattice, column + 1, row + 1);
    const double upper = a + (b - a) * right.value, lower = c + (d - c) * right.value;
    const double across = (b - a) + (d - c - b + a) * down.value;
    return {upper + (lower - upper) * down.value, across * right.slope / spacing,
            (lower - upper) * down.slope / spacing};
  }

  static Slanted flattened(const Slanted& full, double x, double z) {
    const double radius = std::hypot(x, z);
    if (radius >= kFullRadius) return full;
    if (radius <= kFlatRadius) return {};
    const double width = kFullRadius - kFlatRadius;
    const Eased grown = eased((radius - kFlatRadius) / width);
    const double change = full.value * grown.slope / width;
    return {full.value * grown.value, full.along_x * grown.value + change * x / radius,
            full.along_z * grown.value + change * z / radius};
  }

  RoughOptions options_;
};

class Level final : public Terrain {
 public:
  explicit Level(double height) : height_(height) {}

  std::optional<GroundPoint> at(double x, double z, double below) const override {
    if (!std::isfinite(x) || !std::isfinite(z) || !(height_ <= below)) return std::nullopt;
    return GroundPoint{height_, Vec3::UnitY()};
  }

 private:
  double height_;
};

class Slope final : public Terrain {
 public:
  Slope(double angle, double begin)
      : tangent_(std::tan(angle)), begin_(begin), normal_(0, std::cos(angle), -std::sin(angle)) {}

  std::optional<GroundPoint> at(double x, double z, double below) const override {
    if (!std::isfinite(x) || !std::isfinite(z)) return std::nullopt;
    const GroundPoint point =
        z <= begin_ ? GroundPoint{0, Vec3::UnitY()} : GroundPoint{tangent_ * (z - begin_), normal_};
    if (!(point.height <= below)) return std::nullopt;
    return point;
  }

 private:
  double tangent_;
  double begin_;
  Vec3 normal_;
};

class Stairs final : public Terrain {
 public:
  explicit Stairs(const StairsOptions& options) : options_(options) {}

  std::optional<GroundPoint> at(double x, double z, double below) const override {
    if (!std::isfinite(x) || !std::isfinite(z)) return std::nullopt;
    // Risers passed: upwards the one at z itself counts, downwards it does not.
    const double runs = (z - options_.begin) / options_.run;
    const double passed = options_.rise > 0 ? std::floor(runs) + 1 : std::ceil(runs);
    const double height = options_.rise * std::clamp(passed, 0.0, double(options_.count));
    if (!(height <= below)) return std::nullopt;
    return GroundPoint{height, Vec3::UnitY()};
  }

 private:
  StairsOptions options_;
};

}  // namespace

Result<std::unique_ptr<Terrain>> rough(const RoughOptions& options) {
  if (!(options.height >= 0 && options.height <= 10)) {
    return Error("ground-value",
                 fmt::format("rough ground cannot be {} m from low to high", options.height),
                 "use a height from 0 to 10 m");
  }
  return std::unique_ptr<Terrain>(std::make_unique<Rough>(options));
}

Result<std::unique_ptr<Terrain>> level(double height) {
  if (!std::isfinite(height)) return Error("ground-value", "the height is not a finite number");
  return std::unique_ptr<Terrain>(std::make_unique<Level>(height));
}

Result<std::unique_ptr<Terrain>> slope(double angle, double begin) {
  if (!(std::abs(angle) < 60 * kRadiansPerDegree)) {
    return Error("ground-value",
                 fmt::format("a slope of {} degrees is too steep", angle / kRadiansPerDegree),
                 "use an angle of less than 60 degrees, below 0 for a way down");
  }
  if (!std::isfinite(begin)) {
    return Error("ground-value", "the begin of the slope is not a finite number");
  }
  return std::unique_ptr<Terrain>(std::make_unique<Slope>(angle, begin));
}

Result<std::unique_ptr<Terrain>> stairs(const StairsOptions& options) {
  if (!(std::abs(options.rise) <= 1) || options.rise == 0) {
    return Error("ground-value", fmt::format("stairs cannot rise {} m a step", options.rise),
                 "use a rise of at most 1 m, below 0 for stairs that go down");
  }
  if (!(options.run >= 0.05 && options.run <= 100)) {
    return Error("ground-value", fmt::format("treads cannot be {} m long", options.run),
                 "use a run from 5 cm to 100 m");
  }
  if (options.count < 1 || options.count > 100000) {
    return Error("ground-value", fmt::format("stairs cannot have {} steps", options.count),
                 "use a count from 1 to 100000");
  }
  if (!std::isfinite(options.begin)) {
    return Error("ground-value", "the begin of the stairs is not a finite number");
  }
  return std::unique_ptr<Terrain>(std::make_unique<Stairs>(options));
}

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
