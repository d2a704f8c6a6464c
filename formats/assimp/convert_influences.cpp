#include <algorithm>

#include "formats/assimp/influences_internal.h"

namespace krok::assimp {

using namespace nodes;

std::uint16_t SkinBuilder::add(int node, const Mat4& inverse_bind) {
  for (std::size_t k = 0; k < skin_.joints.size(); ++k) {
    if (skin_.joints[k] == node && skin_.inverse_binds[k] == inverse_bind) {
      return static_cast<std::uint16_t>(k);
    }
  }
  if (skin_.joints.size() > 0xFFFE) throw ConversionError("a skin has more than 65535 joints");
  skin_.joints.push_back(node);
  skin_.inverse_binds.push_back(inverse_bind);
  return static_cast<std::uint16_t>(skin_.joints.size() - 1);
}

int SkinBuilder::finish() {
  for (std::size_t s = 0; s < to_.scene.skins.size(); ++s) {
    if (to_.scene.skins[s].joints == skin_.joints &&
        to_.scene.skins[s].inverse_binds == skin_.inverse_binds) {
      return static_cast<int>(s);
    }
  }
  to_.scene.skins.push_back(std::move(skin_));
  return static_cast<int>(to_.scene.skins.size()) - 1;
}

namespace {

Mat4 rest_to_world(const Scene& scene, int node) {
  Mat4 matrix = Mat4::Identity();
  for (; node != -1; node = scene.nodes[static_cast<std::size_t>(node)].parent) {
    const Node& at = scene.nodes[static_cast<std::size_t>(node)];
    matrix =
        (at.has_matrix ? at.matrix : put_together(at.translation, at.rotation, at.scale)) * matrix;
  }
  return matrix;
}

// MilkShape's weights, which Assimp does not read.
std::vector<std::vector<Influence>> ms3d_influences(
    const Ms3dFile& file, const std::vector<std::vector<Ms3dInfluence>>& corners, Conversion& to,
    SkinBuilder& skin) {
  std::vector<int> place(file.joints.size(), -1);  // index in the skin, -1 if not added yet
  std::vector<std::vector<Influence>> influences(corners.size());
  for (std::size_t v = 0; v < corners.size(); ++v) {
    for (const auto& [joint, weight] : corners[v]) {
      int& known = place[static_cast<std::size_t>(joint)];
      if (known == -1) {
        const auto node = to.node_by_name.find(file.joints[static_cast<std::size_t>(joint)]);
        if (node == to.node_by_name.end()) continue;
        known = skin.add(node->second, rest_to_world(to.scene, node->second).inverse());
      }
      influences[v].push_back({static_cast<std::uint16_t>(known), weight});
    }
  }
  return influences;
}

// Influences of each vertex, as in the file.
std::vector<std::vector<Influence>> influences_of(const aiMesh& mesh, Conversion& to,
                                                  SkinBuilder& skin, MeshTotals& totals) {
  std::vector<std::vector<Influence>> influences(mesh.mNumVertices);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const auto found = to.node_by_name.find(to_text(bone.mName));
    if (found == to.node_by_name.end()) {
      ++totals.bones_without_node;
      totals.bone_without_node = to_text(bone.mName);
      continue;
    }
    const std::uint16_t joint = skin.add(found->second, to_matrix(bone.mOffsetMatrix));
    for (unsigned w = 0; w < bone.mNumWeights; ++w) {
      const aiVertexWeight& weight = bone.mWeights[w];
      if (weight.mVertexId >= mesh.mNumVertices || !(weight.mWeight > 0)) continue;
      influences[weight.mVertexId].push_back({joint, std::min(weight.mWeight, 1e6f)});
    }
  }
  return influences;
}

// Binds vertices without influences to their node.
void hang_the_rest(std::vector<std::vector<Influence>>& influences, int mesh_node,
                   SkinBuilder& skin, MeshTotals& totals) {
  for (auto& list : influences) {
    if (!list.empty()) continue;
    ++totals.vertices_without;
    list.push_back({skin.add(mesh_node, Mat4::Identity()), 1.0f});
  }
}

// Sorts by decreasing weight, merges repeated joints, limits to kMaxInfluences, normalises.
void tidy(std::vector<Influence>& list, MeshTotals& totals) {
  std::sort(list.begin(), list.end(),
            [](const Influence& a, const Influence& b) { return a.joint < b.joint; });
  std::size_t kept = 0;
  for (std::size_t k = 1; k < list.size(); ++k) {
    if (list[k].joint == list[kept].joint) {
      list[kept].weight += list[k].weight;
    } else {
      list[++kept] = list[k];
    }
  }
  list.resize(kept + 1);
  std::stable_sort(list.begin(), list.end(),
                   [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
  double all = 0;
  for (const Influence& influence : list) all += static_cast<double>(influence.weight);
  if (list.size() > Primitive::kMaxInfluences) {
    ++totals.vertices_with_too_many;
    double dropped = 0;
    for (std::size_t k = Primitive::kMaxInfluences; k < list.size(); ++k) {
      dropped += static_cast<double>(list[k].weight) / all;
    }
    totals.largest_dropped = std::max(totals.largest_dropped, dropped);
    list.resize(Primitive::kMaxInfluences);
    all = 0;
    for (const Influence& influence : list) all += static_cast<double>(influence.weight);
  }
  for (Influence& influence : list) {
    influence.weight = static_cast<float>(static_cast<double>(influence.weight) / all);
  }
}

}  // namespace

std::vector<std::vector<Influence>> convert_influences(Conversion& to, const aiMesh& mesh, int node,
                                                       const std::optional<Ms3dFile>& ms3d,
                                                       SkinBuilder& skin, MeshTotals& totals) {
  if (mesh.mNumBones == 0) return {};
  std::size_t group = 0;
  while (to.source.mMeshes[group] != &mesh) ++group;
  const bool own = ms3d && group < ms3d->influences.size() &&
                   ms3d->influences[group].size() == mesh.mNumVertices;
  auto influences = own ? ms3d_influences(*ms3d, ms3d->influences[group], to, skin)
                        : influences_of(mesh, to, skin, totals);
  hang_the_rest(influences, node, skin, totals);
  for (auto& list : influences) tidy(list, totals);
  totals.skinned_vertices += influences.size();
  return influences;
}

}  // namespace krok::assimp
