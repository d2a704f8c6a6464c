#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "formats/gltf/document_internal.h"
#include "formats/gltf/gltf_writer.h"

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

namespace {

using Use = Document::Use;

bool finite(std::span<const Vec3f> vectors) {
  return std::all_of(vectors.begin(), vectors.end(),
                     [](const Vec3f& vector) { return vector.allFinite(); });
}

Status check_coloured(const ColouredMesh& mesh) {
  assert(mesh.colours.size() == mesh.positions.size());
  assert(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
  if (!finite(mesh.positions) || !finite(mesh.normals) || !finite(mesh.colours)) {
    return Error("gltf-value", "a vertex of mesh " + mesh.name + " is not finite");
  }
  const auto in_range = [&](const auto& triangle) {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](std::uint32_t corner) { return corner < mesh.positions.size(); });
  };
  assert(std::all_of(mesh.triangles.begin(), mesh.triangles.end(), in_range));
  (void)in_range;
  return {};
}

tinygltf::Primitive primitive_of(const ColouredMesh& mesh, Document& document) {
  tinygltf::Primitive primitive;
  primitive.attributes["POSITION"] = document.add_positions(mesh.positions);
  if (!mesh.normals.empty()) {
    primitive.attributes["NORMAL"] = document.add_vectors(unit_vectors(mesh.normals));
  }
  std::vector<Vec3f> colours(mesh.colours.begin(), mesh.colours.end());
  for (Vec3f& colour : colours) colour = colour.cwiseMax(0.0f).cwiseMin(1.0f);
  primitive.attributes["COLOR_0"] = document.add_vectors(colours);
  primitive.material = 0;
  primitive.mode = TINYGLTF_MODE_POINTS;
  if (!mesh.triangles.empty()) {
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.indices = document.add_integers(
        {mesh.triangles[0].data(), 3 * mesh.triangles.size()}, TINYGLTF_TYPE_SCALAR,
        static_cast<std::uint32_t>(mesh.positions.size() - 1), Use::indices);
  }
  return primitive;
}

}  // namespace

Status write_coloured(std::span<const ColouredMesh> meshes, const std::string& material,
                      const WriteOptions& options, OutputFile& file) {
  Document document(options);
  tinygltf::Material white;
  white.name = material;
  white.pbrMetallicRoughness.metallicFactor = 0.0;
  white.pbrMetallicRoughness.roughnessFactor = 1.0;
  white.doubleSided = true;
  document.gltf.materials.push_back(std::move(white));
  for (const ColouredMesh& coloured : meshes) {
    if (coloured.positions.empty()) continue;
    if (Status status = check_coloured(coloured); !status) return status;
    tinygltf::Mesh mesh;
    mesh.name = coloured.mesh_name.empty() ? coloured.name : coloured.mesh_name;
    mesh.primitives.push_back(primitive_of(coloured, document));
    document.gltf.meshes.push_back(std::move(mesh));
    document.add_mesh_node(static_cast<int>(document.gltf.meshes.size()) - 1, -1, coloured.name);
  }
  if (document.gltf.meshes.empty()) {
    return Error("gltf-empty-mesh", "there is no mesh to write; glTF does not allow empty meshes");
  }
  return document.write(file);
}

}  // namespace krok::gltf
