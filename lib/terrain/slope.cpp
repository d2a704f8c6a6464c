#include "terrain/slope.h"

#include <fmt/format.h>

#include <cmath>

namespace krok::terrain {

namespace {

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

}  // namespace

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

}  // namespace krok::terrain
