#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/reduce_for_mesh.h"

namespace krok::gltf {

// A rig before anything was lost.
struct OriginalRig {
  const Model& model;
  const MorphSet& morphs;
  std::span<const NamedTracks> clips;  // of all frames
};

// What write_rig() was given for it, but for what is lost.
struct WrittenRig {
  const Model& model;                     // its triangles are read
  std::span<const std::uint32_t> places;  // see order_for_compression(); empty: unchanged
};

struct WrittenError {
  MeshError error;  // the vertex is the original's
  std::size_t clip = 0;
};

// The largest distance of a vertex of the original from where the file at `path` shows it, read and
// evaluated as a loader does: at all frames of all clips and half-way between them (between two
// moments both sides are nearly straight lines, whose distance is largest at an end). Vertices
// without a triangle are not compared. Codes: those of read_file(); gltf-mesh if the file does not
// have the rig's triangles.
Result<WrittenError> written_error(const std::string& path, const OriginalRig& original,
                                   const WrittenRig& written, int jobs);

}  // namespace krok::gltf
