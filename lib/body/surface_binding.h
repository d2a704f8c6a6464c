#pragma once

#include "body/polygonise.h"
#include "scene/model.h"

namespace krok::body {

// Fills the influences of a model that has the vertices of `mesh`: from the joints of the tube at
// each vertex and of the tubes blended with it there, then smoothed along the surface in `passes`
// steps, so that weights do not bleed from an arm to the trunk beside it. The four largest weights
// are kept.
void bind_surface(const Mesh& mesh, const BlockedField& field, int passes, int jobs, Model& model);

// Computes the texture coordinates, see Body::model.
void map_surface(const Mesh& mesh, const BlockedField& field, int jobs, Model& model);

}  // namespace krok::body
