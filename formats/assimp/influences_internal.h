#pragma once

#include <optional>
#include <vector>

#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/ms3d_file_internal.h"

// Influences of mesh vertices, and the skins that they use.

namespace krok::assimp {

struct Influence {
  std::uint16_t joint = 0;
  float weight = 0;
};

// Counts for diagnostics reported once per file.
struct MeshTotals {
  std::size_t vertices_with_too_many = 0;
  double largest_dropped = 0;
  std::size_t vertices_without = 0;
  std::size_t skinned_vertices = 0;
  std::size_t lone_faces = 0;
  std::size_t meshes_without_tangents = 0;
  std::size_t bones_without_node = 0;
  std::string bone_without_node;
};

// The skin of one node, merged from the bones of all its meshes.
class SkinBuilder {
 public:
  explicit SkinBuilder(Conversion& to) : to_(to) {}

  // Index of the joint with this bind in the skin; added if new.
  std::uint16_t add(int node, const Mat4& inverse_bind);

  // Index of the skin in the scene; an identical skin is reused.
  int finish();

  bool empty() const { return skin_.joints.empty(); }

 private:
  Conversion& to_;
  nodes::Skin skin_;
};

// Influences of each vertex of a mesh at a node: by decreasing weight, no joint twice, at most
// kMaxInfluences, sum 1. Vertices without influences follow the node. `ms3d` has MilkShape's
// weights, which Assimp does not read. Empty for a mesh without bones.
std::vector<std::vector<Influence>> convert_influences(Conversion& to, const aiMesh& mesh, int node,
                                                       const std::optional<Ms3dFile>& ms3d,
                                                       SkinBuilder& skin, MeshTotals& totals);

}  // namespace krok::assimp
