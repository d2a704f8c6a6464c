#include "tools/krok-morph/shape_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/io/open_character.h"
#include "formats/io/open_scene.h"
#include "formats/obj/obj_reader.h"
#include "formats/pc2/pc2.h"
#include "formats/registry/registry.h"
#include "skin/surface_normals.h"

namespace krok::cli::morph {

namespace {

using registry::Kind;
using Triangle = std::array<std::uint32_t, 3>;

// +Z up, facing -Y, becomes +Y up, facing +Z.
void turn_up(std::vector<Vec3f>& vectors) {
  for (Vec3f& vector : vectors) vector = Vec3f(vector.x(), vector.z(), -vector.y());
}

Result<ShapeFile> read_obj(const InputFile& file, const Options& options, ToolContext& context) {
  auto read = obj::read(file.text(), file.path(), {.metres_per_unit = options.unit.metres});
  if (!read) return read.error();
  context.diagnose_in(file.path(), read->diagnostics);
  ShapeFile shape;
  shape.source = Source::obj;
  shape.model = std::move(read->model);
  if (options.up == Up::z) {
    turn_up(shape.model.positions);
    turn_up(shape.model.normals);
  }
  return shape;
}

Result<ShapeFile> read_any(const InputFile& file, const Options& options, ToolContext& context,
                           bool with_morphs) {
  const Kind kind = registry::identify(file.path(), file.bytes());
  if (kind == Kind::unknown && extension(file.path()) == ".obj") {
    return read_obj(file, options, context);
  }
  if (kind != Kind::model && !io::is_scene(kind)) {
    return Error("morph-input", fmt::format("this is {}, expected .obj, .glb, .gltf or .model",
                                            registry::describe_content(file.bytes())));
  }
  auto actor = io::open_actor(file, context, {.with_morphs = with_morphs, .with_motions = false});
  if (!actor) return actor.error();
  ShapeFile shape;
  shape.source = kind == Kind::model ? Source::model : Source::gltf;
  shape.model = std::move(actor->model);
  shape.materials = std::move(actor->materials);
  shape.morphs = std::move(actor->morphs);
  return shape;
}

// Rotated to start at the smallest index.
Triangle canonical(Triangle one) {
  std::rotate(one.begin(), std::min_element(one.begin(), one.end()), one.end());
  return one;
}

// All triangles canonical and sorted.
std::vector<Triangle> canonical(const std::vector<Triangle>& triangles) {
  std::vector<Triangle> result = triangles;
  for (Triangle& one : result) one = canonical(one);
  std::ranges::sort(result);
  return result;
}

std::string corners(const Triangle& triangle) {
  return fmt::format("{}, {}, {}", triangle[0], triangle[1], triangle[2]);
}

}  // namespace

Result<ShapeFile> read_shape(const std::string& path, const Options& options, ToolContext& context,
                             bool with_morphs) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  auto shape = read_any(*file, options, context, with_morphs);
  if (!shape) return std::move(shape).error().in_file(path);
  shape->path = path;
  Model& model = shape->model;
  if (model.triangles.empty()) {
    return Error("morph-empty", "the file has no triangles").in_file(path);
  }
  shape->has_normals = !model.normals.empty();
  if (!shape->has_normals) {
    model.normals.resize(model.positions.size());
    normals_of(model.triangles, model.positions, shading_groups(model.positions, {}),
               model.normals);
  }
  return shape;
}

Status check_same_mesh(const ShapeFile& base, const ShapeFile& shape, const Options& options) {
  const Model& first = base.model;
  const Model& other = shape.model;
  if (first.vertex_count() != other.vertex_count()) {
    return Error(
               "morph-vertices",
               fmt::format("{}, but {} has {}", counted(other.vertex_count(), "vertex", "vertices"),
                           base_name(base.path), grouped(first.vertex_count())),
               "shapes of a mesh need the same vertices in the same order; exporters may split "
               "vertices along seams")
        .in_file(shape.path);
  }
  if (options.by_order || first.triangles == other.triangles) return {};
  const std::vector<Triangle> known = canonical(first.triangles);
  const std::vector<Triangle> found = canonical(other.triangles);
  if (known == found) return {};
  const char* hint = "use --match order to match vertices by order only";
  for (std::size_t t = 0; t < other.triangles.size(); ++t) {
    if (std::ranges::binary_search(known, canonical(other.triangles[t]))) continue;
    return Error("morph-triangles",
                 fmt::format("triangle {} (vertices {}) is not in {}", t,
                             corners(other.triangles[t]), base_name(base.path)),
                 hint)
        .in_file(shape.path);
  }
  for (std::size_t t = 0; t < first.triangles.size(); ++t) {
    if (std::ranges::binary_search(found, canonical(first.triangles[t]))) continue;
    return Error("morph-triangles",
                 fmt::format("triangle {} of {} (vertices {}) is missing", t, base_name(base.path),
                             corners(first.triangles[t])),
                 hint)
        .in_file(shape.path);
  }
  return Error("morph-triangles",
               fmt::format("{}, but {} has {}; some are duplicates",
                           counted(found.size(), "triangle"), base_name(base.path), known.size()),
               hint)
      .in_file(shape.path);
}

Status check_vertices(const ShapeFile& base, const MorphSet& morphs, const std::string& path) {
  if (morphs.vertex_count == base.model.vertex_count()) return {};
  return Error("morph-vertices",
               fmt::format("the targets have {}, but {} has {}",
                           counted(morphs.vertex_count, "vertex", "vertices"), base_name(base.path),
                           grouped(base.model.vertex_count())),
               "BASE must be the mesh that the targets were packed with")
      .in_file(path);
}

std::vector<Vec3f> normals_for(const ShapeFile& base, const ShapeFile& shape) {
  if (shape.has_normals) return shape.model.normals;
  std::vector<Vec3f> normals(base.model.positions.size());
  moved_normals(base.model.triangles, base.model.positions, base.model.normals,
                shape.model.positions, normals);
  return normals;
}

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
