#include "tools/krok-ragdoll/ground.h"

#include <cmath>

#include "formats/io/open_terrain.h"
#include "terrain/surface.h"

namespace krok::cli::ragdoll {

namespace {

constexpr double kReach = 10;         // metres around the fall
constexpr double kTolerance = 0.001;  // metres

Result<std::vector<std::array<Vec3, 3>>> triangles_of(const Terrain& terrain, const Vec3& centre) {
  // Around whole metres, so that the same ground has the same triangles wherever one falls there.
  const Vec2 middle(std::round(centre.x()), std::round(centre.z()));
  const Vec2 reach(kReach, kReach);
  const auto surface = terrain::surface_of(terrain, {middle - reach, middle + reach, kTolerance});
  if (!surface) return surface.error();
  std::vector<std::array<Vec3, 3>> triangles;
  for (const auto& corners : surface->triangles) {
    std::array<Vec3, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = surface->positions[corners[k]].cast<double>();
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace

Result<krok::ragdoll::Surroundings> open_surroundings(const std::string& ground, const Vec3& centre,
                                                      ToolContext& context) {
  const auto terrain = io::open_terrain(ground, {}, context);
  if (!terrain) return terrain.error();
  krok::ragdoll::Surroundings surroundings;
  if (ground == "level" || ground.starts_with("level:")) {
    surroundings.level = true;
    const auto point = (*terrain)->at(centre.x(), centre.z());
    surroundings.height = point ? point->height : 0;
    return surroundings;
  }
  auto triangles = triangles_of(**terrain, centre);
  if (!triangles) {
    return Error("ragdoll-ground", "there is no ground within 10 m of where the fall begins",
                 "krok-edit moves motions")
        .in_file(ground);
  }
  surroundings.triangles = *std::move(triangles);
  return surroundings;
}

}  // namespace krok::cli::ragdoll
