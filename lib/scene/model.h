#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/provenance.h"
#include "scene/skeleton.h"

namespace krok {

// A triangle mesh bound to a skeleton. Vertices are in the model's reference pose, which is the
// skeleton's: with C_j the reference joint_to_world of joint j and M_j the animated one, linear
// blend skinning moves a vertex v to sum_j w_j M_j C_j^-1 v.
//
// Per-vertex arrays have [vertices] elements, or none if the file has no such data (normals,
// texture_coordinates, tangents, colours). Influences have [vertices x influences_per_vertex]
// elements, vertex by vertex, weights in decreasing order, unused ones with weight 0 and joint 0.
struct Model {
  static constexpr int kMaxInfluences = 8;
  static constexpr int kMaxCoordinateSets = 8;

  Skeleton skeleton;

  std::vector<Vec3f> positions;            // metres
  std::vector<Vec3f> normals;              // unit, pointing outwards
  std::vector<Vec2f> texture_coordinates;  // u to the right, v down (glTF's)
  // The sets after that, glTF's TEXCOORD_1 and so on, each of [vertices]; none without a first set.
  std::vector<std::vector<Vec2f>> more_texture_coordinates;
  std::vector<Vec4f> tangents;  // unit xyz; w is +1 or -1, glTF's handedness
  // Linear red, green, blue, alpha, normally 0 .. 1, by which the material's base colour
  // is multiplied.
  std::vector<Vec4f> colours;

  int influences_per_vertex = 4;  // 1 .. kMaxInfluences
  std::vector<std::uint16_t> influence_joints;
  std::vector<float> influence_weights;  // >= 0, sum to 1 for each vertex

  // Counter-clockwise seen from outside.
  std::vector<std::array<std::uint32_t, 3>> triangles;

  // A range of triangles with one material. Parts cover all triangles in order; a model without
  // materials has one part with an empty material.
  struct Part {
    std::string name;
    std::string material;
    std::uint32_t first_triangle = 0;
    std::uint32_t triangle_count = 0;
    std::string mesh = {};  // that it came from, as exporters name it; may be empty
  };
  std::vector<Part> parts;

  Provenance provenance;

  int vertex_count() const { return static_cast<int>(positions.size()); }
};

// Checks everything documented above (weights in decreasing order with a sum of 1 within 1e-4,
// indices in range, finite values, normals and tangents of length 1 within 1e-3, parts that cover
// the triangles). Codes: those of check(Skeleton), model-shape, model-index, model-weight,
// model-value.
Status check(const Model& model);

// Normalises the influences of every vertex to the form that Model documents and viewers require:
// no joint twice (weights are added), no negative weights, weights in decreasing order (ties by
// joint), unused influences with weight 0 and joint 0, and a sum of 1 up to float rounding. A
// vertex without any positive weight is bound to joint 0. Idempotent up to that rounding. The
// arrays must have the lengths that Model documents.
void normalize_influences(Model& model);

// The most influences with a weight above 0 that a vertex has; at least 1.
int used_influences(const Model& model);

// Keeps the `count` largest influences of each vertex, normalised; influences_per_vertex becomes
// `count` where it is more. Weights are in decreasing order, as Model documents. Returns how many
// vertices lost influences.
int limit_influences(Model& model, int count);

}  // namespace krok
