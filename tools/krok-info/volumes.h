#pragma once

#include <string>
#include <vector>

#include "scene/mesh_volume.h"
#include "tools/krok-info/description.h"

namespace krok::cli::info {

struct NamedVolume {
  std::string mesh;  // empty if there is only one
  MeshVolume measured;
};

// Text: volumes of the closed meshes in litres. JSON: volume (cubic metres; null for open meshes)
// and area (square metres) of all meshes.
void add_volumes(const std::vector<NamedVolume>& volumes, Description& out);

}  // namespace krok::cli::info
