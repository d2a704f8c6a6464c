#pragma once

#include <vector>

#include "ragdoll/bodies.h"
#include "scene/model.h"

namespace krok::ragdoll {

// The bodies as meshes on the skeleton, in its reference pose: a part for each, by its name, whose
// vertices move with the body's joint alone. The material is "bodies".
Model body_meshes(const Skeleton& skeleton, const std::vector<Body>& bodies);

}  // namespace krok::ragdoll
