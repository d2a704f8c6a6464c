#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lint/lint.h"
#include "math/transform.h"

// Finds faults of the meshes of characters. Weights are judged by the readers, which normalise
// them: see tools/krok-lint.

namespace krok::lint {

struct MeshView {
  std::string name;                  // for findings
  std::span<const Vec3f> positions;  // [vertices], in any unit
  std::span<const Vec3f> normals;    // [vertices], as in the file, or empty
  std::span<const std::array<std::uint32_t, 3>> triangles;

  // Of a skinned mesh of a scene, otherwise empty. joint_to_world without animation and
  // mesh_to_joint of the bind pose, [joints].
  std::span<const std::string> joint_names;
  std::span<const Mat4> rests, inverse_binds;
  int influences_per_vertex = 0;
  std::span<const std::uint16_t> influence_joints;
  std::span<const float> influence_weights;
};

// degenerate-triangle, triangle-winding, vertex-normal and bind-pose.
//
// - A triangle is degenerate if it has a vertex twice, or its height is below 1e-6 of its longest
//   side.
// - Winding: of the edges that two triangles share (vertices at the same position are one), those
//   that both run through in the same direction. Triangles that are there twice count once.
// - Normals: zero (any), or over 120 degrees from those of all triangles around.
// - Bind pose, of joints with vertices: matrices that cannot be inverted; scales without animation
//   that differ from the other joints' (a hundredth and less hides what hangs on a joint); edges
//   that the pose without animation makes over 5 times longer, and over a 50th of the mesh's size
//   long.
std::vector<Finding> lint_mesh(const MeshView& mesh, const Settings& settings);

}  // namespace krok::lint
