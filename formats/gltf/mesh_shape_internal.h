#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/gltf/document_internal.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"

// Private to this folder: shared by all writers of meshes.

namespace krok::gltf {

// Whether a model is valid and has triangles. Codes: gltf-empty-mesh and those of check(Model).
Status check_mesh(const Model& model);

// The preferred name of the mesh node; made unique, since joints keep their names.
std::string mesh_name(const WriteOptions& options);

// Normalised vectors; +Y for a zero vector.
std::vector<Vec3f> unit_vectors(std::span<const Vec3f> vectors);

// Calls `visit` for each set of texture coordinates with its name in glTF.
void for_each_coordinate_set(
    const Model& model,
    const std::function<void(const std::string& name, std::span<const Vec2f>)>& visit);

// The attributes shared by all meshes, with the vertices of `shape`; normals and tangents are
// normalised, as glTF requires.
std::map<std::string, int> add_shape(Document& document, const Model& model,
                                     const MeshShape& shape);

}  // namespace krok::gltf
