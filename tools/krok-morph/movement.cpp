#include "tools/krok-morph/movement.h"

#include <fmt/format.h>

#include "core/numbers.h"

namespace krok::cli::morph {

namespace {

constexpr double kMoved = 1e-6;  // metres
constexpr double kMillimetres = 1e3;

}  // namespace

Movement movement_of(std::span<const Vec3f> base, std::span<const Vec3f> target) {
  Movement movement;
  double sum = 0;
  for (std::size_t v = 0; v < base.size(); ++v) {
    const double distance = (target[v].cast<double>() - base[v].cast<double>()).norm();
    if (distance > movement.largest) {
      movement.largest = distance;
      movement.vertex = static_cast<int>(v);
    }
    if (!(distance > kMoved)) continue;
    ++movement.moved;
    sum += distance;
  }
  if (movement.moved > 0) movement.mean = sum / movement.moved;
  return movement;
}

Json to_json(const Movement& movement) {
  Json result;
  result["vertices_moved"] = movement.moved;
  result["largest_distance"] = movement.largest;
  result["vertex"] = movement.vertex < 0 ? Json() : Json(movement.vertex);
  result["mean_distance"] = movement.mean;
  return result;
}

std::string describe(const Movement& movement) {
  if (movement.moved == 0) return "no displacement";
  return fmt::format("moves {}, max {} mm (vertex {}), mean {} mm",
                     counted(movement.moved, "vertex", "vertices"),
                     readable(movement.largest * kMillimetres, 3), movement.vertex,
                     readable(movement.mean * kMillimetres, 3));
}

}  // namespace krok::cli::morph
