#pragma once

#include <string>
#include <vector>

#include "description.h"
#include "scene/mesh_volume.h"

namespace krok::info {

struct NamedVolume {
  std::string mesh;  // empty where there is but one
  MeshVolume measured;
};

// Volumes of the meshes that are closed, in litres, and in JSON volume (cubic metres; null where
// the mesh is open) and area (square metres) of all.
void add_volumes(const std::vector<NamedVolume>& volumes, Description& out);

}  // namespace krok::info
