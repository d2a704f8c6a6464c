#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>

#include "core/file.h"
#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/fbx_text_internal.h"
#include "formats/assimp/ms3d_file_internal.h"

namespace krok::assimp {

using namespace nodes;

namespace {

struct Influence {
  std::uint16_t joint = 0;
  float weight = 0;
};

// What is said once for the whole file.
struct Totals {
  std::size_t vertices_with_too_many = 0;
  double largest_dropped = 0;
  std::size_t vertices_without = 0;
  std::size_t skinned_vertices = 0;
  std::size_t lone_faces = 0;
  std::size_t bones_without_node = 0;
  std::string bone_without_node;
};

Vec3f to_float(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

// The skin of one node, joined from the bones of all its meshes.
class SkinBuilder {
 public:
  explicit SkinBuilder(Conversion& to) : to_(to) {}

  // The place of a joint with this bind in the skin's list.
  std::uint16_t add(int node, const Mat4& inverse_bind) {
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

  // The skin's place in the scene; one with the same joints and binds is used again.
  int finish() {
    for (std::size_t s = 0; s < to_.scene.skins.size(); ++s) {
      if (to_.scene.skins[s].joints == skin_.joints &&
          to_.scene.skins[s].inverse_binds == skin_.inverse_binds) {
        return static_cast<int>(s);
      }
    }
    to_.scene.skins.push_back(std::move(skin_));
    return static_cast<int>(to_.scene.skins.size()) - 1;
  }

  bool empty() const { return skin_.joints.empty(); }

 private:
  Conversion& to_;
  Skin skin_;
};

Mat4 rest_to_world(const Scene& scene, int node) {
  Mat4 matrix = Mat4::Identity();
  for (; node != -1; node = scene.nodes[static_cast<std::size_t>(node)].parent) {
    const Node& at = scene.nodes[static_cast<std::size_t>(node)];
    matrix =
        (at.has_matrix ? at.matrix : put_together(at.translation, at.rotation, at.scale)) * matrix;
  }
  return matrix;
}

// MilkShape's weights, which Assimp has not.
std::vector<std::vector<Influence>> ms3d_influences(
    const Ms3dFile& file, const std::vector<std::vector<Ms3dInfluence>>& corners, Conversion& to,
    SkinBuilder& skin) {
  std::vector<int> place(file.joints.size(), -1);  // in the skin, of the joints met so far
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

// [vertices] lists of influences, as the file has them.
std::vector<std::vector<Influence>> influences_of(const aiMesh& mesh, Conversion& to,
                                                  SkinBuilder& skin, Totals& totals) {
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

// Vertices without influences stay where their node is.
void hang_the_rest(std::vector<std::vector<Influence>>& influences, int mesh_node,
                   SkinBuilder& skin, Totals& totals) {
  for (auto& list : influences) {
    if (!list.empty()) continue;
    ++totals.vertices_without;
    list.push_back({skin.add(mesh_node, Mat4::Identity()), 1.0f});
  }
}

// The largest first, no joint twice, at most kMostInfluences, a sum of 1.
void tidy(std::vector<Influence>& list, Totals& totals) {
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
  if (list.size() > Primitive::kMostInfluences) {
    ++totals.vertices_with_too_many;
    double dropped = 0;
    for (std::size_t k = Primitive::kMostInfluences; k < list.size(); ++k) {
      dropped += static_cast<double>(list[k].weight) / all;
    }
    totals.largest_dropped = std::max(totals.largest_dropped, dropped);
    list.resize(Primitive::kMostInfluences);
    all = 0;
    for (const Influence& influence : list) all += static_cast<double>(influence.weight);
  }
  for (Influence& influence : list) {
    influence.weight = static_cast<float>(static_cast<double>(influence.weight) / all);
  }
}

// Vertices that are the same in everything become one: most importers give three to a triangle.
// Normals may differ by what exporters' rounding does to those of one smooth vertex.
class VertexJoiner {
 public:
  // The vertex's place among the different ones so far.
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

  Primitive build(std::size_t& lone_faces) {
    join_vertices();
    fill_vertices();
    fill_targets();
    for (unsigned f = 0; f < mesh_.mNumFaces; ++f) {
      const aiFace& face = mesh_.mFaces[f];
      if (face.mNumIndices != 3) {
        ++lone_faces;
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
      for (const float x : {v.x, v.y, v.z}) append(x + 0.0f);  // -0 is 0
    };
    const auto append_normal = [&](const aiVector3D& v) {
      constexpr float kSteps = 1e4f;
      for (const float x : {v.x, v.y, v.z}) append(std::round(x * kSteps) + 0.0f);
    };
    for (unsigned v = 0; v < mesh_.mNumVertices; ++v) {
      key.clear();
      append_exact(mesh_.mVertices[v]);
      if (mesh_.mNormals != nullptr) append_normal(mesh_.mNormals[v]);
      if (mesh_.mTextureCoords[0] != nullptr) append_exact(mesh_.mTextureCoords[0][v]);
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
        Vec2f coordinate(at.x, 1.0f - at.y);  // Assimp's run up
        if (!coordinate.allFinite()) coordinate.setZero();
        coordinates->push_back(coordinate);
      }
    }
    primitive_.positions = std::move(positions);
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

  // Assimp's targets are whole vertices, ours are displacements.
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
  std::vector<std::uint32_t> new_place_;
  std::vector<unsigned> kept_;
  Primitive primitive_;
};

// A material's name; of those that Assimp named itself the picture's.
std::string material_name(const aiScene& source, unsigned index) {
  if (index >= source.mNumMaterials) return {};
  const aiMaterial& material = *source.mMaterials[index];
  aiString name, picture;
  const bool named = material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS;
  const std::string text = named ? to_text(name) : std::string();
  const bool by_assimp = text.empty() || text.starts_with("Texture_");
  if (by_assimp && material.GetTexture(aiTextureType_DIFFUSE, 0, &picture) == aiReturn_SUCCESS) {
    std::string path = to_text(picture);
    std::replace(path.begin(), path.end(), '\\', '/');
    return base_name(path);
  }
  return text == AI_DEFAULT_MATERIAL_NAME ? std::string() : text;
}

// A mesh that can be shown: with vertices that are numbers.
bool usable(const aiMesh& mesh) {
  if (mesh.mNumVertices == 0 || mesh.mVertices == nullptr || mesh.mNumFaces == 0) return false;
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    if (!to_float(mesh.mVertices[v]).allFinite()) return false;
  }
  return true;
}

void convert_node_meshes(Conversion& to, const std::vector<const aiMesh*>& meshes, int node,
                         const std::optional<Ms3dFile>& ms3d, Totals& totals) {
  Mesh mesh;
  SkinBuilder skin(to);
  for (const aiMesh* source : meshes) {
    std::vector<std::vector<Influence>> influences;
    if (source->mNumBones > 0) {
      std::size_t group = 0;
      while (to.source.mMeshes[group] != source) ++group;
      const bool own = ms3d && group < ms3d->influences.size() &&
                       ms3d->influences[group].size() == source->mNumVertices;
      influences = own ? ms3d_influences(*ms3d, ms3d->influences[group], to, skin)
                       : influences_of(*source, to, skin, totals);
      hang_the_rest(influences, node, skin, totals);
      for (auto& list : influences) tidy(list, totals);
      totals.skinned_vertices += influences.size();
    }
    if (mesh.name.empty()) mesh.name = to_text(source->mName);
    Primitive primitive = PrimitiveBuilder(*source, std::move(influences)).build(totals.lone_faces);
    primitive.material = material_name(to.source, source->mMaterialIndex);
    mesh.primitives.push_back(std::move(primitive));
  }
  const aiMesh& first = *meshes[0];
  for (unsigned t = 0; t < first.mNumAnimMeshes; ++t) {
    // Assimp 5.2 says 1 of FBX's targets whatever the file says; fix_fbx_target_weights knows.
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
            "morph targets are not all at rest in the file, and Assimp does not say which; all "
            "begin at rest");
  }
}

void report(Conversion& to, const Totals& totals) {
  if (totals.vertices_with_too_many > 0) {
    to.warn("assimp-influences",
            fmt::format("{} vertices hang on more than 8 joints; the smallest weights were left "
                        "out, up to {:.3g} % of a vertex",
                        totals.vertices_with_too_many, 100 * totals.largest_dropped));
  }
  if (totals.vertices_without > 0) {
    to.warn("assimp-weights",
            fmt::format("{} of {} vertices of skinned meshes have no weights and stay with their "
                        "mesh's node",
                        totals.vertices_without, totals.skinned_vertices));
  }
  if (totals.bones_without_node > 0) {
    to.warn("assimp-bone",
            fmt::format("{} bones are no nodes of the file, {} for one; their weights are left out",
                        totals.bones_without_node, totals.bone_without_node));
  }
  if (totals.lone_faces > 0) {
    to.note("assimp-lines", fmt::format("{} points and lines are left out", totals.lone_faces));
  }
}

}  // namespace

void convert_meshes(Conversion& to) {
  Totals totals;
  std::optional<Ms3dFile> ms3d;
  if (to.kind == registry::Kind::ms3d) ms3d = read_ms3d(std::as_bytes(std::span(to.text)));
  std::size_t unusable = 0;
  // In the order of our nodes, so that the result does not depend on that of a hash table.
  std::map<int, const aiNode*> in_order;
  for (const auto& [source, node] : to.node_of) in_order.emplace(node, source);
  for (const auto& [node, source] : in_order) {
    // Those with the same number of morph targets make one mesh; others get nodes of their own.
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
      convert_node_meshes(to, meshes, holder, ms3d, totals);
      holder = -1;
    }
  }
  if (unusable > 0) {
    to.warn(
        "assimp-mesh",
        fmt::format("{} meshes without faces or with positions that are no numbers are left out",
                    unusable));
  }
  if (to.kind == registry::Kind::fbx) fix_fbx_target_weights(to);
  report(to, totals);
}

}  // namespace krok::assimp
