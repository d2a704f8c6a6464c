#pragma once

#include <optional>
#include <vector>

#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/ms3d_file_internal.h"

// Which joints the vertices of a mesh hang on, and the skins that these make.

namespace krok::assimp {

struct Influence {
  std::uint16_t joint = 0;
  float weight = 0;
};

// What is said once for the whole file, of influences and of faces.
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

// The skin of one node, joined from the bones of all its meshes.
class SkinBuilder {
 public:
  explicit SkinBuilder(Conversion& to) : to_(to) {}

  // The place of a joint with this bind in the skin's list.
  std::uint16_t add(int node, const Mat4& inverse_bind);

  // The skin's place in the scene; one with the same joints and binds is used again.
  int finish();

  bool empty() const { return skin_.joints.empty(); }

 private:
  Conversion& to_;
  nodes::Skin skin_;
};

// [vertices] lists of influences of a mesh at a node: the largest first, no joint twice, at most
// Primitive::kMostInfluences, a sum of 1. Vertices without any stay where the node is. `ms3d` has
// MilkShape's weights, which Assimp has not. None for a mesh without bones.
std::vector<std::vector<Influence>> convert_influences(Conversion& to, const aiMesh& mesh, int node,
                                                       const std::optional<Ms3dFile>& ms3d,
                                                       SkinBuilder& skin, MeshTotals& totals);

}  // namespace krok::assimp
