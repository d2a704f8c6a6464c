#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "formats/gltf/document_internal.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/quantize.h"
#include "scene/morph_set.h"

// Private to the writers: vertices as integers of 16 and 8 bits (KHR_mesh_quantization).

namespace krok::gltf {

// Positions are stored as whole steps from a corner of the mesh's box.
struct PositionGrid {
  Vec3 corner = Vec3::Zero();
  double step = 1;

  static PositionGrid of(std::span<const Vec3f> positions, const Quantization& quantization);
  Mat4 to_model() const;  // from stored to model positions
};

// As add_shape() and add_influences() together. `shape` is the model's own.
std::map<std::string, int> add_quantized_shape(Document& document, const Model& model,
                                               const PositionGrid& grid,
                                               const Quantization& quantization);

// What a file holds of each vertex, as rows of `size` bytes: vertices with equal ones are the same.
// Without a quantization, the exact values. `morphs` may have no targets.
struct VertexRows {
  std::size_t size = 0;
  std::vector<std::byte> bytes;
};
VertexRows vertex_rows(const Model& model, const MorphSet& morphs,
                       const std::optional<Quantization>& quantization);

// The displacements of morph targets in steps of the grid.
std::map<std::string, int> add_quantized_target(Document& document, const Model& model,
                                                const MorphSet& morphs, int target,
                                                const PositionGrid& grid, bool with_normals);

}  // namespace krok::gltf
