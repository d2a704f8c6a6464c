#pragma once

#include <cstdint>

#include "core/file.h"
#include "core/progress.h"
#include "core/result.h"
#include "formats/gltf/gltf_writer.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"

// Writes animated meshes without a skeleton to glTF 2.0: one whole file to an empty OutputFile, as
// in gltf_writer.h.

namespace krok::gltf {

// A mesh in the shape of the first frame, with one morph target for each further frame. Weights are
// keyed so that each frame is shown exactly at its time, with linear blending in between.
//
// Vertices are streamed into the file: memory holds a few frames, plus some kilobytes of JSON per
// frame. With `jobs` other than 1 (as in parallel_for) frames are computed while others are
// written; the bytes are the same. A GLB to a stream (see OutputFile) computes all frames twice,
// because the bounds of all frames precede the vertices.
//
// Codes besides those of gltf_writer.h: gltf-structure for a motion without frames or a vertex that
// is not finite.
Status write_baked(const Model& model, const MeshMotion& motion, const WriteOptions& options,
                   OutputFile& file, Progress* progress = nullptr, int jobs = 1);

// Bytes of vertices and weights of a baked motion, for checking its size before writing. Includes
// tangents if `materials` need them.
std::uint64_t baked_bytes(const Model& model, std::int64_t frames,
                          std::span<const Material> materials = {});

// Max bytes of binary data that the writers put into a file (code gltf-too-large): GLB lengths have
// 32 bits, and some room is left for the JSON.
inline constexpr std::uint64_t kMaxDataBytes =
    (std::uint64_t{4} << 30) - (std::uint64_t{256} << 20);

// WebGL 2 viewers store morph targets in the layers of a texture array; this is a common limit.
inline constexpr int kMaxMorphTargets = 2048;

}  // namespace krok::gltf
