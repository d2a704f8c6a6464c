#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "compare/measure.h"
#include "math/types.h"

// Parts of comparing meshes that models and scenes share.

namespace krok::compare {

using Triangle = std::array<std::uint32_t, 3>;

// What differs between two lists of triangles, in words for people; empty if they are the same
// surface: the same triangles in any order, each beginning at any of its corners. A triangle that
// is turned over (its corners the other way round) differs.
std::string difference_in_triangles(std::span<const Triangle> first,
                                    std::span<const Triangle> second);

// The influences of a mesh's vertices, shape [vertices x per_vertex].
struct Influences {
  int per_vertex = 0;
  std::span<const std::uint16_t> joints;
  std::span<const float> weights;
};

// Adds for each vertex the largest difference of a joint's weight. A joint that appears twice for a
// vertex counts with the sum. `first_of_second` turns a joint of the second into one of the first
// (-1: it has none; any weight on it differs). `place` gives the mesh.
void add_weight_differences(const Influences& first, const Influences& second,
                            std::span<const int> first_of_second, ValueLocation place,
                            Measure& measure);

// Adds for each vertex the distance of positions, the angle of directions, or the largest
// difference of texture coordinates. Spans of equal length; places get `vertex` on top of `place`.
void add_distances(std::span<const Vec3> first, std::span<const Vec3> second, ValueLocation place,
                   Measure& measure);
void add_distances(std::span<const Vec3f> first, std::span<const Vec3f> second, ValueLocation place,
                   Measure& measure);
void add_angles(std::span<const Vec3> first, std::span<const Vec3> second, ValueLocation place,
                Measure& measure);
void add_angles(std::span<const Vec3f> first, std::span<const Vec3f> second, ValueLocation place,
                Measure& measure);
void add_coordinate_differences(std::span<const Vec2f> first, std::span<const Vec2f> second,
                                ValueLocation place, Measure& measure);

// Whether two tangents stand on other sides: the signs of their w differ. One that vanishes, or
// that lies between corners which disagree (|w| < 0.5), has no side.
bool on_other_sides(const Vec4& first, const Vec4& second);

}  // namespace krok::compare
