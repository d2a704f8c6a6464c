#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <unordered_map>

#include "formats/assimp/primitive_internal.h"

namespace krok::assimp {

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

Primitive convert_primitive(const aiMesh& mesh, std::vector<std::vector<Influence>> influences,
                            MeshTotals& totals) {
  return PrimitiveBuilder(mesh, std::move(influences)).build(totals);
}

}  // namespace krok::assimp
