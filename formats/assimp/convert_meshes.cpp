#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>

#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/fbx_text_internal.h"
#include "formats/assimp/influences_internal.h"
#include "formats/assimp/materials_internal.h"
#include "formats/assimp/ms3d_file_internal.h"
#include "formats/assimp/primitive_internal.h"
#include "nodes/materials.h"

namespace krok::assimp {

using namespace nodes;

namespace {

// Whether a mesh has faces and finite positions.
bool usable(const aiMesh& mesh) {
  if (mesh.mNumVertices == 0 || mesh.mVertices == nullptr || mesh.mNumFaces == 0) return false;
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    if (!to_float(mesh.mVertices[v]).allFinite()) return false;
  }
  return true;
}

void convert_node_meshes(Conversion& to, const std::vector<const aiMesh*>& meshes, int node,
                         const std::optional<Ms3dFile>& ms3d, MaterialBuilder& materials,
                         MeshTotals& totals) {
  Mesh mesh;
  SkinBuilder skin(to);
  for (const aiMesh* source : meshes) {
    auto influences = convert_influences(to, *source, node, ms3d, skin, totals);
    if (mesh.name.empty()) mesh.name = to_text(source->mName);
    Primitive primitive = convert_primitive(*source, std::move(influences), totals);
    primitive.material = material_name(to.source, source->mMaterialIndex);
    if (to.with_materials) primitive.material_index = materials.index_of(source->mMaterialIndex);
    mesh.primitives.push_back(std::move(primitive));
  }
  const aiMesh& first = *meshes[0];
  for (unsigned t = 0; t < first.mNumAnimMeshes; ++t) {
    // Assimp 5.2 gives FBX targets weight 1 whatever the file has; see fix_fbx_target_weights.
    const bool known = to.kind != registry::Kind::fbx;
    const auto weight = known ? static_cast<double>(first.mAnimMeshes[t]->mWeight) : 0.0;
    mesh.weights.push_back(std::isfinite(weight) ? weight : 0.0);
  }
  Node& target = to.scene.nodes[static_cast<std::size_t>(node)];
  target.mesh = static_cast<int>(to.scene.meshes.size());
  if (!skin.empty()) target.skin = skin.finish();
  to.scene.meshes.push_back(std::move(mesh));
}

void fix_fbx_target_weights(Conversion& to) {
  const std::vector<double> weights = fbx_target_weights(to.text);
  if (std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0; })) {
    return;
  }
  Mesh* only = nullptr;
  std::size_t meshes = 0;
  for (Mesh& mesh : to.scene.meshes) {
    if (mesh.weights.empty()) continue;
    only = &mesh;
    ++meshes;
  }
  if (meshes == 1 && only->weights.size() == weights.size()) {
    only->weights = weights;
  } else if (meshes > 0) {
    to.warn("assimp-targets",
            "default weights of morph targets in the file cannot be assigned, as Assimp does not "
            "identify the targets; all are 0");
  }
}

void report(Conversion& to, const MeshTotals& totals) {
  if (totals.vertices_with_too_many > 0) {
    to.warn("assimp-influences",
            fmt::format("{} vertices have more than 8 influences; the smallest weights were "
                        "left out, up to {:.3g} % of a vertex",
                        totals.vertices_with_too_many, 100 * totals.largest_dropped));
  }
  if (totals.vertices_without > 0) {
    to.warn("assimp-weights",
            fmt::format("{} of {} vertices of skinned meshes have no weights and are bound to "
                        "their mesh's node",
                        totals.vertices_without, totals.skinned_vertices));
  }
  if (totals.bones_without_node > 0) {
    to.warn("assimp-bone",
            fmt::format("{} bones have no node in the file, such as {}; their weights are left out",
                        totals.bones_without_node, totals.bone_without_node));
  }
  if (totals.meshes_without_tangents > 0) {
    to.warn("assimp-tangents", fmt::format("{} meshes have invalid tangents, which are left out",
                                           totals.meshes_without_tangents));
  }
  if (totals.lone_faces > 0) {
    to.note("assimp-lines", fmt::format("{} points and lines are left out", totals.lone_faces));
  }
}

}  // namespace

void convert_meshes(Conversion& to) {
  MeshTotals totals;
  MaterialBuilder materials(to);
  std::optional<Ms3dFile> ms3d;
  if (to.kind == registry::Kind::ms3d) ms3d = read_ms3d(std::as_bytes(std::span(to.text)));
  std::size_t unusable = 0;
  // In node order, so that the result does not depend on the hash table's order.
  std::map<int, const aiNode*> in_order;
  for (const auto& [source, node] : to.node_of) in_order.emplace(node, source);
  for (const auto& [node, source] : in_order) {
    // Meshes with the same number of morph targets are merged; others get separate nodes.
    std::map<unsigned, std::vector<const aiMesh*>> by_targets;
    for (unsigned k = 0; k < source->mNumMeshes; ++k) {
      if (source->mMeshes[k] >= to.source.mNumMeshes) continue;
      const aiMesh* mesh = to.source.mMeshes[source->mMeshes[k]];
      if (usable(*mesh)) {
        by_targets[mesh->mNumAnimMeshes].push_back(mesh);
      } else {
        ++unusable;
      }
    }
    int holder = node;
    for (const auto& [targets, meshes] : by_targets) {
      if (holder == -1) {
        holder = static_cast<int>(to.scene.nodes.size());
        Node extra;
        extra.name = to.scene.nodes[static_cast<std::size_t>(node)].name + "_mesh";
        extra.parent = node;
        to.scene.nodes.push_back(std::move(extra));
      }
      convert_node_meshes(to, meshes, holder, ms3d, materials, totals);
      holder = -1;
    }
  }
  if (unusable > 0) {
    to.warn(
        "assimp-mesh",
        fmt::format("{} meshes without faces or with non-finite positions are left out", unusable));
  }
  if (to.kind == registry::Kind::fbx) fix_fbx_target_weights(to);
  report(to, totals);
  nodes::make_names_unique(to.scene.materials);
  materials.report();
}

}  // namespace krok::assimp
