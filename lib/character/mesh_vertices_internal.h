#pragma once

#include "nodes/scene.h"
#include "scene/model.h"

// Private to this folder.

namespace krok::character {

// Normals from the triangles for the vertices whose normal is zero, each triangle counting by its
// area; up where that gives none. The model has normals.
void make_missing_normals(Model& model);

// Whether two primitives have the very same vertices, as those of one mesh with several materials
// often do.
bool same_vertices(const nodes::Primitive& a, const nodes::Primitive& b);

}  // namespace krok::character
