#include "tools/krok-morph/motion_file.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/pc2/pc2.h"

namespace krok::cli::morph {

namespace {

// Larger baked files are an error.
constexpr std::uint64_t kMaxBakedBytes = std::uint64_t{1} << 30;

gltf::WriteOptions gltf_options(const ShapeFile& shape, MotionFormat format,
                                const ToolContext& context) {
  gltf::WriteOptions options;
  options.binary = format == MotionFormat::glb;
  options.provenance = context.provenance();
  options.name = "shape";
  options.materials = shape.materials;
  options.unnamed_is_none = shape.source == Source::gltf;
  return options;
}

Status check_bakeable(const ShapeFile& shape, int frames, const std::string& path) {
  const std::uint64_t bytes = gltf::baked_bytes(shape.model, frames, shape.materials);
  if (frames - 1 <= gltf::kMaxMorphTargets && bytes <= kMaxBakedBytes) return {};
  return Error("morph-clip-too-long",
               fmt::format("{} of {} need {} morph targets and {} MB; viewers support at most {}, "
                           "and the limit is {} MB",
                           counted(frames, "frame"),
                           counted(shape.model.vertex_count(), "vertex", "vertices"), frames - 1,
                           (bytes >> 20) + 1, gltf::kMaxMorphTargets, kMaxBakedBytes >> 20),
               "use --as targets or a .pc2 file for any length, or a lower --rate")
      .in_file(path);
}

constexpr double kMoved = 1e-6;  // metres
constexpr double kMillimetres = 1e3;

}  // namespace

Result<MotionFormat> motion_format(const std::string& path, bool exr) {
  const std::string end = extension(path);
  if (end == ".glb" || path == "-") return MotionFormat::glb;
  if (end == ".gltf") return MotionFormat::gltf;
  if (end == ".pc2") return MotionFormat::pc2;
  if (end == ".exr" && exr) return MotionFormat::exr;
  return Error("morph-format",
               end.empty() ? fmt::format("{} has no extension; cannot determine the format", path)
                           : fmt::format("unsupported extension {}", end),
               exr ? "use .glb, .gltf, .pc2 or .exr" : "use .glb, .gltf or .pc2")
      .in_file(path);
}

Status add_baked(const ShapeFile& shape, const MeshMotion& motion, MotionFormat format,
                 OutputSet& outputs, ToolContext& context) {
  if (format == MotionFormat::pc2) {
    return outputs.add(context.output, [&](OutputFile& file) {
      return pc2::write(shape.model, motion, {}, file, context.progress, context.jobs);
    });
  }
  if (Status status = check_bakeable(shape, motion.frames, context.output); !status) return status;
  return outputs.add(context.output, [&](OutputFile& file) {
    return gltf::write_baked(shape.model, motion, gltf_options(shape, format, context), file,
                             context.progress, context.jobs);
  });
}

Status add_targets(const ShapeFile& shape, const MorphSet& morphs, const MorphWeights& weights,
                   MotionFormat format, OutputSet& outputs, ToolContext& context) {
  gltf::WriteOptions options = gltf_options(shape, format, context);
  const Model& model = shape.model;
  options.morphs = &morphs;
  options.weights = &weights;
  return outputs.add(context.output, [&](OutputFile& file) {
    return gltf::write_mesh(model, {model.positions, model.normals, model.tangents}, options, file);
  });
}

Movement movement_of(std::span<const Vec3f> base, std::span<const Vec3f> target) {
  Movement movement;
  double sum = 0;
  for (std::size_t v = 0; v < base.size(); ++v) {
    const double distance = (target[v].cast<double>() - base[v].cast<double>()).norm();
    if (distance > movement.largest) {
      movement.largest = distance;
      movement.vertex = static_cast<int>(v);
    }
    if (!(distance > kMoved)) continue;
    ++movement.moved;
    sum += distance;
  }
  if (movement.moved > 0) movement.mean = sum / movement.moved;
  return movement;
}

Json to_json(const Movement& movement) {
  Json result;
  result["vertices_moved"] = movement.moved;
  result["largest_distance"] = movement.largest;
  result["vertex"] = movement.vertex < 0 ? Json() : Json(movement.vertex);
  result["mean_distance"] = movement.mean;
  return result;
}

std::string describe(const Movement& movement) {
  if (movement.moved == 0) return "no displacement";
  return fmt::format("moves {}, max {} mm (vertex {}), mean {} mm",
                     counted(movement.moved, "vertex", "vertices"),
                     readable(movement.largest * kMillimetres, 3), movement.vertex,
                     readable(movement.mean * kMillimetres, 3));
}

}  // namespace krok::cli::morph
