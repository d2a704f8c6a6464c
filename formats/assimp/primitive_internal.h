#pragma once

#include <vector>

#include "formats/assimp/influences_internal.h"

namespace krok::assimp {

Vec3f to_float(const aiVector3D& vector);

// Converts one of Assimp's meshes, without its material's name. Vertices with identical attributes
// are merged. `influences` are from convert_influences().
nodes::Primitive convert_primitive(const aiMesh& mesh,
                                   std::vector<std::vector<Influence>> influences,
                                   MeshTotals& totals);

}  // namespace krok::assimp
