#include "tools/krok-ragdoll/ground.h"

#include <cmath>
#include <optional>

#include "formats/io/open_terrain.h"

namespace krok::cli::ragdoll {

namespace {

constexpr double kSpacing = 0.02, kReach = 4;  // metres
constexpr int kCells = static_cast<int>(2 * kReach / kSpacing);

std::vector<std::array<Vec3, 3>> triangles_of(const Terrain& terrain, const Vec3& centre) {
  // On a lattice of its own, so that the same ground has the same triangles wherever one falls.
  const double x = (std::round(centre.x() / kSpacing) - kCells / 2) * kSpacing;
  const double z = (std::round(centre.z() / kSpacing) - kCells / 2) * kSpacing;
  const auto row = [&](int j) {
    std::vector<std::optional<Vec3>> points;
    for (int i = 0; i <= kCells; ++i) {
      const double px = x + i * kSpacing, pz = z + j * kSpacing;
      const auto point = terrain.at(px, pz);
      points.push_back(point ? std::optional<Vec3>(Vec3(px, point->height, pz)) : std::nullopt);
    }
    return points;
  };
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<std::optional<Vec3>> before = row(0);
  for (int j = 1; j <= kCells; ++j) {
    std::vector<std::optional<Vec3>> after = row(j);
    for (std::size_t i = 0; i + 1 < after.size(); ++i) {
      const auto &a = before[i], &b = before[i + 1], &c = after[i], &d = after[i + 1];
      if (a && c && b) triangles.push_back({*a, *c, *b});
      if (b && c && d) triangles.push_back({*b, *c, *d});
    }
    before = std::move(after);
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
  surroundings.triangles = triangles_of(**terrain, centre);
  if (surroundings.triangles.empty()) {
    return Error("ragdoll-ground", "there is no ground within 4 m of where the fall begins",
                 "krok-edit moves motions")
        .in_file(ground);
  }
  return surroundings;
}

}  // namespace krok::cli::ragdoll
