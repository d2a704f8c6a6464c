#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/file.h"
#include "core/progress.h"
#include "core/result.h"
#include "math/transform.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"

// PC2 point caches: the vertex positions of a mesh per frame; the mesh itself is in another file
// with the same vertices. See SPEC.md for the layout.
//
// Codes: pc2-format, pc2-version, pc2-truncated, pc2-value, pc2-option, pc2-too-large.

namespace krok::pc2 {

// The axes of the file.
enum class Up : unsigned char {
  y,  // as in all of Krok: +Y up, facing +Z; as in OBJ and FBX files
  z,  // (x, -z, y), +Z up, facing -Y; as in meshes of Blender and 3ds Max
};

struct WriteOptions {
  Up up = Up::y;
  double scale = 1.0;              // units per metre: 100 for centimetres
  double start_frame = 0.0;        // frame of the host application at the first sample
  double frames_per_sample = 1.0;  // of the host application; the file does not store its rate
};

// Writes one whole file to `file`: one sample per frame of `motion`, whose shapes have as many
// vertices as the model. Memory holds two frames. With `jobs` other than 1 (as in parallel_for) it
// holds a few more, and frames are computed while others are written; the bytes are the same.
// Codes: pc2-option (scale not positive, values beyond a float), pc2-too-large (2^31 vertices or
// frames).
Status write(const Model& model, const MeshMotion& motion, const WriteOptions& options,
             OutputFile& file, Progress* progress = nullptr, int jobs = 1);

// A point cache in memory. Views the bytes that it was read from.
class PointCache {
 public:
  // Checks the header against the file size; get() checks the positions. Codes: pc2-format (not a
  // PC2 file), pc2-version, pc2-truncated, pc2-value (invalid header).
  static Result<PointCache> read(std::span<const std::byte> file);

  std::int64_t points() const { return points_; }
  std::int64_t samples() const { return samples_; }
  float start_frame() const { return start_frame_; }
  float frames_per_sample() const { return frames_per_sample_; }

  // Bytes after the last sample; some programs write them, and they are ignored.
  std::size_t bytes_left() const { return bytes_left_; }

  // The positions of a sample, [points], in the file's axes and units. Code: pc2-value for a number
  // that is not finite.
  Status get(std::int64_t sample, std::span<Vec3f> positions) const;

 private:
  PointCache() = default;
  std::span<const std::byte> data_;
  std::int64_t points_ = 0, samples_ = 0;
  float start_frame_ = 0, frames_per_sample_ = 1;
  std::size_t bytes_left_ = 0;
};

}  // namespace krok::pc2
