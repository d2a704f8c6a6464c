#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/gltf/document_internal.h"

namespace krok::gltf {

namespace {

using Use = Document::Use;

// glTF requires unit normals; the model's may have any length.
Vec3f unit_or_up(const Vec3f& vector) {
  const Vec3 direction = vector.cast<double>();
  const double length = direction.norm();
  if (!(length > 1e-15) || !std::isfinite(length)) return Vec3f::UnitY();
  return (direction / length).cast<float>();
}

std::vector<Vec4f> unit_tangents(std::span<const Vec4f> tangents) {
  std::vector<Vec4f> result;
  for (const Vec4f& tangent : tangents) {
    const Vec3f direction = unit_or_up(tangent.head<3>());
    result.emplace_back(direction.x(), direction.y(), direction.z(), tangent.w() < 0 ? -1.f : 1.f);
  }
  return result;
}

}  // namespace

std::vector<Vec3f> unit_vectors(std::span<const Vec3f> vectors) {
  std::vector<Vec3f> result(vectors.size());
  std::transform(vectors.begin(), vectors.end(), result.begin(), unit_or_up);
  return result;
}

Status check_mesh(const Model& model) {
  if (Status status = check(model); !status) return status;
  if (model.positions.empty() || model.triangles.empty()) {
    return Error("gltf-empty-mesh", "the model has no triangles; glTF does not allow empty meshes");
  }
  return {};
}

std::string mesh_name(const WriteOptions& options) {
  return options.name + "_mesh";
}

void for_each_coordinate_set(
    const Model& model,
    const std::function<void(const std::string& name, std::span<const Vec2f>)>& visit) {
  if (!model.texture_coordinates.empty()) visit("TEXCOORD_0", model.texture_coordinates);
  for (std::size_t s = 0; s < model.more_texture_coordinates.size(); ++s) {
    visit(fmt::format("TEXCOORD_{}", s + 1), model.more_texture_coordinates[s]);
  }
}

std::map<std::string, int> add_shape(Document& document, const Model& model,
                                     const MeshShape& shape) {
  std::map<std::string, int> attributes;
  attributes["POSITION"] = document.add_positions(shape.positions);
  if (!shape.normals.empty()) {
    attributes["NORMAL"] = document.add_vectors(unit_vectors(shape.normals));
  }
  if (!shape.tangents.empty()) {
    const auto tangents = unit_tangents(shape.tangents);
    attributes["TANGENT"] = document.add_floats({tangents.data()->data(), tangents.size() * 4},
                                                TINYGLTF_TYPE_VEC4, Use::vertices, false);
  }
  for_each_coordinate_set(model, [&](const std::string& name, std::span<const Vec2f> set) {
    attributes[name] = document.add_floats({set.data()->data(), set.size() * 2}, TINYGLTF_TYPE_VEC2,
                                           Use::vertices, false);
  });
  if (!model.colours.empty()) {
    attributes["COLOR_0"] =
        document.add_floats({model.colours.data()->data(), model.colours.size() * 4},
                            TINYGLTF_TYPE_VEC4, Use::vertices, false);
  }
  return attributes;
}

}  // namespace krok::gltf
