#include "terrain/level.h"

#include <cmath>

namespace krok::terrain {

namespace {

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

}  // namespace

Result<std::unique_ptr<Terrain>> level(double height) {
  if (!std::isfinite(height)) return Error("ground-value", "the height is not a finite number");
  return std::unique_ptr<Terrain>(std::make_unique<Level>(height));
}

}  // namespace krok::terrain
