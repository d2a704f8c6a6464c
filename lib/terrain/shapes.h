#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

struct RoughOptions {
  std::uint64_t seed = 1;
  double height = 0.08;  // metres from the lowest place possible to the highest, 0 to 10
};

// Rough ground without end, the same for the same options on every machine: the sum of two value
// noises (random heights on a square lattice, joined by the quintic 6 t^5 - 15 t^4 + 10 t^3, so
// that height, slope and curvature are continuous), of wavelengths 1.2 m and 0.4 m, that is
// lattices of 0.6 m and 0.2 m, which have 3/4 and 1/4 of the height. It is 0 within 0.3 m of the
// origin, where the walker starts, and grows to its full height over the next 0.7 m. Beyond 1e9 m
// there is none. Code: ground-value for a height outside the range.
Result<std::unique_ptr<Terrain>> rough(const RoughOptions& options);

// A level plane without end, `height` metres above the origin.
// Code: ground-value for a height that is not finite.
Result<std::unique_ptr<Terrain>> level(double height = 0);

// A plane that is level at height 0 up to z = `begin` metres, then rises along +Z at `angle`
// radians without end; below 0 it falls. On the crease itself the level side's normal counts.
// Code: ground-value for an angle of 60 degrees and more, and values that are not finite.
Result<std::unique_ptr<Terrain>> slope(double angle, double begin = 1);

struct StairsOptions {
  double rise = 0.17;  // metres from tread to tread, -1 to 1 but not 0; below 0 they go down
  double run = 0.29;   // metres from edge to edge, 0.05 to 100
  int count = 20;      // risers, 1 to 100,000
  double begin = 1;    // metres, z of the first riser
};

// Stairs along +Z, without end to both sides: level at height 0 before `begin`, then treads `run`
// long, each `rise` above the one before, then a level landing at count * rise. At an edge the
// upper tread counts. Code: ground-value for values outside the ranges above.
Result<std::unique_ptr<Terrain>> stairs(const StairsOptions& options);

// Heights on a grid. Seen from above with +X to the right, row 0 is at the top: columns go along
// +X, rows along +Z. The outermost samples lie on the border.
struct HeightField {
  int columns = 0, rows = 0;          // at least 2 each
  std::vector<float> heights;         // columns * rows, row by row, metres; NaN: a hole
  double width = 0, depth = 0;        // metres along X and Z, from first sample to last, above 0
  double centre_x = 0, centre_z = 0;  // metres
};

// The most samples that a height field may have: 256 MiB of them.
inline constexpr std::int64_t kMaxHeights = std::int64_t{1} << 26;

// Ground that is bilinear between the samples, so it is never above or below those around. There is
// none outside the field, nor in a square of four samples of which one is a hole.
// Codes: ground-size for a field without area, too few or too many samples or heights of another
// count; ground-value for infinite heights; ground-empty if all of it is holes.
Result<std::unique_ptr<Terrain>> height_field(HeightField field);

// Counter-clockwise seen from the side that can be stood on; metres, world.
using GroundTriangle = std::array<Vec3, 3>;

inline constexpr std::size_t kMaxGroundTriangles = 50'000'000;

// The triangles that face up as ground: others, the undersides of bridges and walls, do not carry.
// If triangles that face down cover more than twice as much, the winding is taken to be reversed
// and `reversed` (if given) is set. Along an edge that two triangles share there is no gap. Heights
// are computed in doubles. Found by a tree of boxes (Embree).
// Codes: ground-empty if nothing faces up; ground-value for corners that are not finite or farther
// than 1e6 m from the origin; ground-size for too many triangles.
Result<std::unique_ptr<Terrain>> mesh_ground(std::vector<GroundTriangle> triangles,
                                             bool* reversed = nullptr);

// All triangles of a ground made by mesh_ground(), those that do not carry too, to the accuracy of
// floats; empty for other kinds.
std::optional<std::vector<GroundTriangle>> triangles_of(const Terrain& ground);

}  // namespace krok::terrain
