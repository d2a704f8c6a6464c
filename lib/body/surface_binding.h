#pragma once

#include "body/polygonise.h"
#include "scene/model.h"

namespace krok::body {

// Fills the influences of a model with as many vertices as `mesh`: from the joints of the tube
// that each vertex lies on and, where tubes melt together, of those beside it; then smoothed along
// the surface by `passes` steps, so that nothing bleeds from an arm to the trunk that it hangs
// against. The best four remain.
void bind_surface(const Mesh& mesh, const BlockedField& field, int passes, int jobs, Model& model);

// Fills the texture coordinates, see Body::model.
void map_surface(const Mesh& mesh, const BlockedField& field, int jobs, Model& model);

}  // namespace krok::body
