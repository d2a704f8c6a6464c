#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/pc2/header_internal.h"
#include "formats/pc2/pc2.h"
#include "math/vector_arrays.h"

namespace krok::pc2 {

namespace {

Status check_option(const char* what, double value) {
  if (std::isfinite(value) && std::abs(value) <= std::numeric_limits<float>::max()) return {};
  return Error("pc2-option", fmt::format("a point cache cannot store the {} {}", what, value));
}

Status check(const WriteOptions& options) {
  if (Status status = check_option("start frame", options.start_frame); !status) return status;
  if (Status status = check_option("scale", options.scale); !status) return status;
  if (Status status = check_option("sampling", options.frames_per_sample); !status) return status;
  if (!(options.scale > 0)) return Error("pc2-option", "the scale must be greater than 0");
  if (static_cast<float>(options.frames_per_sample) > 0) return {};
  return Error("pc2-option", "the frames per sample must be greater than 0");
}

// Converts a shape to the file's axes and units.
Status convert(const WriteOptions& options, int frame, std::span<Vec3f> positions) {
  const auto scale = static_cast<float>(options.scale);
  if (options.up == Up::z) {
    for (Vec3f& position : positions) position = Vec3f(position.x(), -position.z(), position.y());
  }
  if (scale != 1.0f) {
    for (Vec3f& position : positions) position *= scale;
  }
  if (all_finite(positions)) return {};
  return Error("pc2-value", fmt::format("a vertex of frame {} is not finite", frame));
}

}  // namespace

Status write(const Model& model, const MeshMotion& motion, const WriteOptions& options,
             OutputFile& file, Progress* progress, int jobs) {
  if (Status status = check(options); !status) return status;
  const std::size_t points = model.positions.size();
  if (points > kMaxCount) {
    return Error("pc2-too-large", fmt::format("{} vertices exceed the limit of PC2 files", points));
  }
  Header header;
  header.points = static_cast<std::int32_t>(points);
  header.start_frame = static_cast<float>(options.start_frame);
  header.frames_per_sample = static_cast<float>(options.frames_per_sample);
  header.samples = std::max(motion.frames, 0);
  if (Status status = file.write(std::as_bytes(std::span(&header, 1))); !status) return status;
  if (progress != nullptr) {
    progress->begin("writing frames", static_cast<std::uint64_t>(header.samples));
  }
  std::vector<std::span<const std::byte>> bytes;
  return make_shapes(
      motion, {0, header.samples, points, false}, jobs,
      [&](int frame, ShapeRoom& shape) { return convert(options, frame, shape.positions); },
      [&](int, std::span<const ShapeRoom> shapes) {
        if (progress != nullptr) progress->advance(shapes.size());
        bytes.clear();
        for (const ShapeRoom& shape : shapes) {
          bytes.push_back(std::as_bytes(std::span(shape.positions)));
        }
        return file.write(bytes);
      });
}

}  // namespace krok::pc2
