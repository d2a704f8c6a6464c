#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/file.h"
#include "core/progress.h"
#include "core/result.h"
#include "math/types.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"

// PC2 point caches: the vertices of a mesh frame after frame, for a mesh of the same vertices that
// another file holds. SPEC.md tells the layout.
//
// Codes: pc2-format, pc2-version, pc2-truncated, pc2-value, pc2-option, pc2-too-large.

namespace krok::pc2 {

// The axes of the numbers in the file.
enum class Up : unsigned char {
  y,  // as everywhere here: +Y up, facing +Z; what an OBJ or FBX file holds
  z,  // (x, -z, y), +Z up, facing -Y: what Blender's and 3ds Max's own meshes hold
};

struct WriteOptions {
  Up up = Up::y;
  double scale = 1.0;              // units a metre: 100 for centimetres
  double start_frame = 0.0;        // the player's frame that shows the first sample
  double frames_per_sample = 1.0;  // of the player; the file does not tell its rate
};

// Appends one whole file to `file`: a sample for each frame of `motion`, whose shapes have as many
// vertices as the model. Holds two frames in memory, with jobs other than 1 a few more, and then
// makes frames while others are written (jobs as in parallel_for). The bytes are the same for any
// `jobs`. Codes: pc2-option (scale not positive, numbers beyond a float), pc2-too-large (2^31
// vertices or frames).
Status write(const Model& model, const MeshMotion& motion, const WriteOptions& options,
             OutputFile& file, Progress* progress = nullptr, int jobs = 1);

// A point cache in memory. Views the bytes that it was read from.
class PointCache {
 public:
  // Checks the header against the size of the file; the positions are looked at by get(). Codes:
  // pc2-format (no PC2 file), pc2-version, pc2-truncated, pc2-value (a header that cannot be).
  static Result<PointCache> read(std::span<const std::byte> file);

  std::int64_t points() const { return points_; }
  std::int64_t samples() const { return samples_; }
  float start_frame() const { return start_frame_; }
  float frames_per_sample() const { return frames_per_sample_; }

  // Bytes after the last sample, which other programs leave and ignore.
  std::size_t bytes_left() const { return bytes_left_; }

  // The positions of a sample, [points], as they are in the file. Code pc2-value: a number that is
  // not finite.
  Status get(std::int64_t sample, std::span<Vec3f> positions) const;

 private:
  PointCache() = default;
  std::span<const std::byte> data_;
  std::int64_t points_ = 0, samples_ = 0;
  float start_frame_ = 0, frames_per_sample_ = 1;
  std::size_t bytes_left_ = 0;
};

}  // namespace krok::pc2
