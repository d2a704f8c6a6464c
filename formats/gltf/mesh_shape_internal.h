#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/gltf/document_internal.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"

// Private to this folder: what all meshes that are written have in common.

namespace krok::gltf {

// Whether a model is sound and has triangles. Codes: gltf-empty-mesh and those of check(Model).
Status check_mesh(const Model& model);

// The name of a mesh's node. It must not collide with a joint's, which keeps its own.
std::string mesh_name(const WriteOptions& options);

// Each vector at length 1; +Y where it has none.
std::vector<Vec3f> unit_vectors(std::span<const Vec3f> vectors);

// The attributes that every mesh has, with the vertices of `shape`; normals and tangents are
// brought to length 1, which glTF asks for.
std::map<std::string, int> add_shape(Document& document, const Model& model,
                                     const MeshShape& shape);

}  // namespace krok::gltf
