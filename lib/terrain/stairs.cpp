#include "terrain/stairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace krok::terrain {

namespace {

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

}  // namespace krok::terrain
