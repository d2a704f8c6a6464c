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

// A mesh with vertex colours, in scene coordinates (metres).
struct ColouredMesh {
  std::string name;  // of the node; made unique
  std::span<const Vec3f> positions;
  std::span<const Vec3f> normals;                           // [vertices] or empty
  std::span<const Vec3f> colours;                           // [vertices], linear RGB, 0 .. 1
  std::span<const std::array<std::uint32_t, 3>> triangles;  // empty: drawn as points
  std::string mesh_name{};                                  // if not that of the node
};

// Writes static meshes with vertex colours (COLOR_0) and a white, rough, lit material called
// `material`. Meshes without vertices are skipped. Codes: gltf-empty-mesh if none remains,
// gltf-too-large, gltf-name, gltf-value for values that are not finite.
Status write_coloured(std::span<const ColouredMesh> meshes, const std::string& material,
                      const WriteOptions& options, OutputFile& file);

}  // namespace krok::gltf
