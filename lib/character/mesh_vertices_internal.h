#pragma once

#include "nodes/scene.h"
#include "scene/model.h"

// Private to this folder.

namespace krok::character {

// Computes area-weighted normals for the vertices whose normal is zero; +Y if the triangles give
// none. The model must have normals.
void make_missing_normals(Model& model);

// Whether two primitives have identical vertices, as is common for a mesh with several materials.
bool same_vertices(const nodes::Primitive& a, const nodes::Primitive& b);

}  // namespace krok::character
