#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "core/file.h"
#include "core/result.h"
#include "formats/gltf/gltf_writer.h"
#include "math/types.h"

namespace krok::gltf {

// A mesh whose vertices have colours, as it stands in the scene (metres).
struct ColouredMesh {
  std::string name;  // of its node; made unique
  std::span<const Vec3f> positions;
  std::span<const Vec3f> normals;                           // [vertices] or none
  std::span<const Vec3f> colours;                           // [vertices], linear RGB, 0 .. 1
  std::span<const std::array<std::uint32_t, 3>> triangles;  // none: the vertices show as points
};

// Writes meshes that do not move, each with its vertices' colours (COLOR_0) on a white, rough
// material called `material`. Lights shade them, so that their shape can be seen. Meshes without a
// vertex are left out. Codes: gltf-empty-mesh where none is left, gltf-too-large, gltf-name,
// gltf-value for values that are not finite.
Status write_coloured(std::span<const ColouredMesh> meshes, const std::string& material,
                      const WriteOptions& options, OutputFile& file);

}  // namespace krok::gltf
