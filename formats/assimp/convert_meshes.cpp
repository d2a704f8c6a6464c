#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/fbx_elements_internal.h"
#include "formats/assimp/run_assimp_internal.h"
#include "nodes/scene.h"

namespace krok::assimp {

namespace {

// Influences of mesh vertices, and the skins that they use.

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

}  // namespace

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

// Influences of each vertex of a mesh at a node: by decreasing weight, no joint twice, at most
// kMaxInfluences, sum 1. Vertices without influences follow the node. `ms3d` has MilkShape's
// weights, which Assimp does not read. Empty for a mesh without bones.
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

using namespace nodes;

Vec3f to_float(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

namespace {

// Merges vertices with identical attributes: most importers give three per triangle. Normals may
// differ by the rounding of exporters.
class VertexJoiner {
 public:
  // The index of the merged vertex.
  std::uint32_t add(std::span<const char> key) {
    const auto [entry, added] = places_.try_emplace(std::string(key.data(), key.size()),
                                                    static_cast<std::uint32_t>(places_.size()));
    return entry->second;
  }
  std::size_t size() const { return places_.size(); }

 private:
  std::unordered_map<std::string, std::uint32_t> places_;
};

class PrimitiveBuilder {
 public:
  PrimitiveBuilder(const aiMesh& mesh, std::vector<std::vector<Influence>> influences)
      : mesh_(mesh), influences_(std::move(influences)) {}

  Primitive build(MeshTotals& totals) {
    find_tangents(totals);
    join_vertices();
    fill_vertices();
    fill_targets();
    for (unsigned f = 0; f < mesh_.mNumFaces; ++f) {
      const aiFace& face = mesh_.mFaces[f];
      if (face.mNumIndices != 3) {
        ++totals.lone_faces;
        continue;
      }
      std::array<std::uint32_t, 3> triangle{};
      bool whole = true;
      for (unsigned k = 0; k < 3; ++k) {
        whole = whole && face.mIndices[k] < mesh_.mNumVertices;
        if (whole) triangle[k] = new_place_[face.mIndices[k]];
      }
      if (whole) primitive_.triangles.push_back(triangle);
    }
    return std::move(primitive_);
  }

 private:
  // The sign follows the file's bitangent, which points to the top of the texture, as in glTF. All
  // or none: an invalid tangent drops all others.
  void find_tangents(MeshTotals& totals) {
    if (!mesh_.HasTangentsAndBitangents() || mesh_.mNormals == nullptr) return;
    for (unsigned v = 0; v < mesh_.mNumVertices; ++v) {
      const Vec3f tangent = to_float(mesh_.mTangents[v]);
      const float length = tangent.stableNorm();
      if (!(length > 0) || !std::isfinite(length)) {
        ++totals.meshes_without_tangents;
        tangents_.clear();
        return;
      }
      const Vec3f third = to_float(mesh_.mNormals[v]).cross(tangent);
      const float side = third.dot(to_float(mesh_.mBitangents[v])) < 0 ? -1.0f : 1.0f;
      const Vec3f unit = tangent / length;
      tangents_.emplace_back(unit.x(), unit.y(), unit.z(), side);
    }
  }

  void join_vertices() {
    VertexJoiner joiner;
    new_place_.resize(mesh_.mNumVertices);
    std::string key;
    const auto append = [&key](const auto& value) {
      const std::size_t at = key.size();
      key.resize(at + sizeof(value));
      std::memcpy(key.data() + at, &value, sizeof(value));
    };
    const auto append_exact = [&](const aiVector3D& v) {
      for (const float x : {v.x, v.y, v.z}) append(x + 0.0f);  // turns -0 into 0
    };
    const auto append_normal = [&](const aiVector3D& v) {
      constexpr float kSteps = 1e4f;
      for (const float x : {v.x, v.y, v.z}) append(std::round(x * kSteps) + 0.0f);
    };
    const auto append_tangent = [&](const Vec4f& t) {
      append_normal({t.x(), t.y(), t.z()});
      append(t.w());
    };
    for (unsigned v = 0; v < mesh_.mNumVertices; ++v) {
      key.clear();
      append_exact(mesh_.mVertices[v]);
      if (mesh_.mNormals != nullptr) append_normal(mesh_.mNormals[v]);
      if (mesh_.mTextureCoords[0] != nullptr) append_exact(mesh_.mTextureCoords[0][v]);
      if (!tangents_.empty()) append_tangent(tangents_[v]);
      for (unsigned t = 0; t < mesh_.mNumAnimMeshes; ++t) {
        const aiAnimMesh& target = *mesh_.mAnimMeshes[t];
        if (target.mVertices != nullptr && v < target.mNumVertices)
          append_exact(target.mVertices[v]);
        if (target.mNormals != nullptr && v < target.mNumVertices)
          append_normal(target.mNormals[v]);
      }
      if (!influences_.empty()) {
        for (const Influence& influence : influences_[v]) {
          append(influence.joint);
          append(influence.weight);
        }
      }
      new_place_[v] = joiner.add(key);
      if (new_place_[v] == kept_.size()) kept_.push_back(v);
    }
  }

  void fill_vertices() {
    auto positions = std::make_shared<std::vector<Vec3f>>();
    auto normals = std::make_shared<std::vector<Vec3f>>();
    auto coordinates = std::make_shared<std::vector<Vec2f>>();
    for (const unsigned v : kept_) {
      positions->push_back(to_float(mesh_.mVertices[v]));
      if (mesh_.mNormals != nullptr) {
        Vec3f normal = to_float(mesh_.mNormals[v]);
        if (!normal.allFinite()) normal.setZero();
        const float length = normal.stableNorm();
        if (length > 0) normal /= length;
        normals->push_back(normal);
      }
      if (mesh_.mTextureCoords[0] != nullptr) {
        const aiVector3D& at = mesh_.mTextureCoords[0][v];
        Vec2f coordinate(at.x, 1.0f - at.y);  // Assimp's v is up
        if (!coordinate.allFinite()) coordinate.setZero();
        coordinates->push_back(coordinate);
      }
    }
    primitive_.positions = std::move(positions);
    if (!tangents_.empty()) {
      auto tangents = std::make_shared<std::vector<Vec4f>>();
      for (const unsigned v : kept_) tangents->push_back(tangents_[v]);
      primitive_.tangents = std::move(tangents);
    }
    if (mesh_.mNormals != nullptr) primitive_.normals = std::move(normals);
    if (mesh_.mTextureCoords[0] != nullptr) primitive_.texture_coordinates = std::move(coordinates);
    if (influences_.empty()) return;
    std::size_t most = 0;
    for (const unsigned v : kept_) most = std::max(most, influences_[v].size());
    const std::size_t each = most > 4 ? 8 : 4;
    primitive_.influences_per_vertex = static_cast<int>(each);
    primitive_.influence_joints.assign(kept_.size() * each, 0);
    primitive_.influence_weights.assign(kept_.size() * each, 0.0f);
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      const auto& list = influences_[kept_[i]];
      for (std::size_t k = 0; k < list.size(); ++k) {
        primitive_.influence_joints[i * each + k] = list[k].joint;
        primitive_.influence_weights[i * each + k] = list[k].weight;
      }
    }
  }

  // Assimp's targets are absolute, ours are displacements.
  void fill_targets() {
    for (unsigned t = 0; t < mesh_.mNumAnimMeshes; ++t) {
      const aiAnimMesh& source = *mesh_.mAnimMeshes[t];
      MorphTarget& target = primitive_.targets.emplace_back();
      target.name = to_text(source.mName);
      if (source.mNumVertices != mesh_.mNumVertices) continue;
      const auto displacements = [&](const aiVector3D* moved, const aiVector3D* rest) {
        auto values = std::make_shared<std::vector<Vec3f>>();
        for (const unsigned v : kept_) {
          const Vec3f displacement = to_float(moved[v]) - to_float(rest[v]);
          values->push_back(displacement.allFinite() ? displacement : Vec3f::Zero());
        }
        return values;
      };
      if (source.mVertices != nullptr) {
        target.positions = displacements(source.mVertices, mesh_.mVertices);
      }
      if (source.mNormals != nullptr && mesh_.mNormals != nullptr) {
        target.normals = displacements(source.mNormals, mesh_.mNormals);
      }
    }
  }

  const aiMesh& mesh_;
  std::vector<std::vector<Influence>> influences_;
  std::vector<Vec4f> tangents_;  // [mesh's vertices] or empty
  std::vector<std::uint32_t> new_place_;
  std::vector<unsigned> kept_;
  Primitive primitive_;
};

}  // namespace

// Converts one of Assimp's meshes, without its material's name. Vertices with identical attributes
// are merged. `influences` are from convert_influences().
Primitive convert_primitive(const aiMesh& mesh, std::vector<std::vector<Influence>> influences,
                            MeshTotals& totals) {
  return PrimitiveBuilder(mesh, std::move(influences)).build(totals);
}

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
