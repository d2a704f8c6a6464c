#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compare/measure.h"
#include "math/transform.h"
#include "scene/scene.h"

// Mesh comparison shared by models and scenes.

namespace krok::compare {

using Triangle = std::array<std::uint32_t, 3>;

// Readable difference between two lists of triangles; empty if they are the same surface: the same
// triangles in any order, starting at any corner. A triangle with reversed winding differs.
std::string difference_in_triangles(std::span<const Triangle> first,
                                    std::span<const Triangle> second);

// The same triangles wound the other way.
std::vector<Triangle> reversed(std::span<const Triangle> triangles);

using Influences = SkinInfluences;

// Adds the largest difference of joint weights, per vertex. Weights of a joint that appears twice
// for a vertex are summed. `first_of_second` maps joints of the second to the first (-1: no
// partner, so any weight on it is a difference). `place` gives the mesh.
void add_weight_differences(const Influences& first, const Influences& second,
                            std::span<const int> first_of_second, ValueLocation place,
                            Measure& measure);

// Add one difference per vertex: distance of positions, angle of directions, or largest difference
// of texture coordinates. Spans have equal length; locations are `place` plus `vertex`.
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
void add_colour_differences(std::span<const Vec4f> first, std::span<const Vec4f> second,
                            ValueLocation place, Measure& measure);

// Whether two tangents have opposite handedness (sign of w). A zero tangent, or one between corners
// that disagree (|w| < 0.5), has none.
bool on_other_sides(const Vec4& first, const Vec4& second);

}  // namespace krok::compare
