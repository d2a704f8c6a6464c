#pragma once

#include <cstdint>

#include "core/file.h"
#include "core/progress.h"
#include "core/result.h"
#include "formats/gltf/gltf_writer.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"

// glTF 2.0 files of meshes in motion without a skeleton. As the functions of gltf_writer.h, each
// appends one whole file to an OutputFile to which nothing was written before.

namespace krok::gltf {

// A mesh whose morph targets are the frames after the first (the mesh itself is the first), with
// weights keyed so that at the time of a frame exactly that frame shows, and between two frames the
// linear blend of both.
//
// Vertices go into the file as they are made: what is held in memory are a few frames, and some
// kilobytes for each (the file's JSON while it is put together). `jobs` other than 1 (as in
// parallel_for) makes frames while others are written; the bytes are the same. A GLB into a stream
// (see OutputFile) makes all frames twice, for glTF wants the bounds of each before the first.
//
// Codes beside those of gltf_writer.h: gltf-structure for a motion without frames or a vertex that
// is not finite.
Status write_baked(const Model& model, const MeshMotion& motion, const WriteOptions& options,
                   OutputFile& file, Progress* progress = nullptr, int jobs = 1);

// What a baked motion takes, to be judged before it is made: bytes of vertices and weights. With
// tangents where `materials` need them.
std::uint64_t baked_bytes(const Model& model, std::int64_t frames,
                          std::span<const Material> materials = {});

// The most bytes of data that write_baked and its neighbours put into a file (code gltf-too-large):
// GLB tells lengths in 32 bits, and some room is left for the JSON.
inline constexpr std::uint64_t kMaxDataBytes =
    (std::uint64_t{4} << 30) - (std::uint64_t{256} << 20);

// Browsers (WebGL 2) hold morph targets in the layers of one texture; common hardware has this
// many.
inline constexpr int kMaxMorphTargets = 2048;

}  // namespace krok::gltf
