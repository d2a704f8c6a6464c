#include "formats/gltf/gltf_writer.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "formats/gltf/document_internal.h"

namespace krok::gltf {

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
