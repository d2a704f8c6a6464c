#pragma once

#include <vector>

#include "formats/assimp/influences_internal.h"

namespace krok::assimp {

Vec3f to_float(const aiVector3D& vector);

// One of Assimp's meshes as a primitive, without its material's name. Vertices that are the same in
// everything become one. `influences` as convert_influences has them.
nodes::Primitive convert_primitive(const aiMesh& mesh,
                                   std::vector<std::vector<Influence>> influences,
                                   MeshTotals& totals);

}  // namespace krok::assimp
