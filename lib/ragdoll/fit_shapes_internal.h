#pragma once

#include "ragdoll/bodies.h"

namespace krok::ragdoll {

// Brings the shapes to the sizes of the model's vertices: sides and radii, not where the bones
// begin and end. Bodies with fewer than 12 vertices stay.
void fit_shapes(const Model& model, std::vector<Body>& bodies);

}  // namespace krok::ragdoll
