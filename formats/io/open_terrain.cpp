#include "formats/io/open_terrain.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "core/numbers.h"
#include "formats/io/open_scene.h"
#include "formats/obj/obj_reader.h"
#include "nodes/evaluate.h"
#include "terrain/shapes.h"
#include "terrain/spec.h"

namespace krok::io {

namespace {

constexpr double kMaxStep = 0.003;  // metres between two grey levels, without a warning

using Ground = Result<std::unique_ptr<Terrain>>;

bool is_image(const InputFile& file) {
  const std::string_view text = file.text();
  return text.starts_with("\x76\x2F\x31\x01") || text.starts_with("\x89PNG") ||
         text.starts_with("\xFF\xD8\xFF");
}

// What of `given` is missing is taken from the image's sidecar, if there is one.
Result<height_field::Placement> placement_of(const std::string& path,
                                             const height_field::Placement& given, Inputs& inputs) {
  if (path == "-") return given;
  const std::string beside = std::filesystem::path(path).replace_extension(".ground.json").string();
  inputs.depends_on_neighbours(path, base_name(beside));
  std::error_code ignored;
  if (!std::filesystem::exists(beside, ignored)) return given;
  const auto file = inputs.open_input(beside);
  if (!file) return file.error();
  auto placement = height_field::read_sidecar(file->text());
  if (!placement) return std::move(placement.error()).in_file(beside);
  if (given.size) placement->size = given.size;
  if (given.range) placement->range = given.range;
  if (given.centre) placement->centre = given.centre;
  return placement;
}

Ground open_image(const InputFile& file, const height_field::Placement& given, Inputs& inputs) {
  const auto placement = placement_of(file.path(), given, inputs);
  if (!placement) return placement.error();
  auto image = height_field::read(file.bytes());
  if (!image) return std::move(image.error()).in_file(file.path());
  const int levels = image->levels;
  auto field = height_field::placed(*std::move(image), *placement);
  if (!field) return std::move(field.error()).in_file(file.path());
  if (levels > 0) {
    const auto [low, high] = *placement->range;
    const double step = std::abs(high - low) / (levels - 1);
    if (step > kMaxStep) {
      inputs.diagnose(make_diagnostic(
          Severity::warning, "ground-levels",
          fmt::format("the image has {} grey levels, so heights differ by steps of {} mm",
                      grouped(levels), readable(1000 * step, 3)),
          "save it as a 16-bit PNG or as EXR from the program that made it", file.path()));
    }
  }
  auto ground = terrain::height_field(*std::move(field));
  if (!ground) return std::move(ground.error()).in_file(file.path());
  return ground;
}

Ground ground_of(std::vector<terrain::GroundTriangle> triangles, const std::string& path,
                 Inputs& inputs) {
  bool reversed = false;
  auto ground = terrain::mesh_ground(std::move(triangles), &reversed);
  if (!ground) return std::move(ground.error()).in_file(path);
  if (reversed) {
    inputs.diagnose(make_diagnostic(
        Severity::note, "ground-reversed",
        "most of the mesh faces down; it is taken to be wound the other way round", "", path));
  }
  return ground;
}

Ground open_obj(const InputFile& file, Inputs& inputs) {
  const auto shape = obj::read(file.text(), file.path());
  if (!shape) return shape.error();
  inputs.diagnose(shape->diagnostics);
  const Model& model = shape->model;
  std::vector<terrain::GroundTriangle> triangles;
  triangles.reserve(model.triangles.size());
  for (const auto& corners : model.triangles) {
    terrain::GroundTriangle& triangle = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = model.positions[corners[k]].cast<double>();
  }
  return ground_of(std::move(triangles), file.path(), inputs);
}

Ground open_mesh_scene(const InputFile& file, Inputs& inputs) {
  const auto scene = open_scene(file, inputs);
  if (!scene) return scene.error();
  inputs.diagnose(scene->diagnostics);
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return Error(evaluator.error()).in_file(file.path());
  nodes::Evaluation world;
  evaluator->evaluate(-1, 0, world);
  const double metres = scene->space.metres.value_or(1);
  const Quat turn = scene->space.file_to_krok.value_or(Quat::Identity());
  std::vector<terrain::GroundTriangle> triangles;
  for (std::size_t i = 0; i < evaluator->instances().size(); ++i) {
    const nodes::Instance& instance = evaluator->instances()[i];
    // A node that mirrors turns the winding round.
    const Mat4& placed = world.node_to_world[static_cast<std::size_t>(instance.node)];
    const bool mirrored = placed.topLeftCorner<3, 3>().determinant() < 0;
    for (auto corners : evaluator->primitive(instance).triangles) {
      if (mirrored) std::swap(corners[1], corners[2]);
      terrain::GroundTriangle& triangle = triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        triangle[k] = turn * (metres * world.positions[i][corners[k]]);
      }
    }
  }
  return ground_of(std::move(triangles), file.path(), inputs);
}

Ground open_ground_file(const std::string& path, const height_field::Placement& placement,
                        Inputs& inputs) {
  const auto file = inputs.open_input(path);
  if (!file) return file.error();
  if (is_image(*file)) return open_image(*file, placement, inputs);
  if (placement.size || placement.range || placement.centre) {
    return Error("usage", "size and range of the ground are for height fields (EXR, PNG)")
        .in_file(path);
  }
  if (is_scene(registry::identify(path, file->bytes()))) return open_mesh_scene(*file, inputs);
  if (extension(path) == ".obj") return open_obj(*file, inputs);
  return Error("ground-kind",
               fmt::format("{} cannot be ground", registry::describe_content(file->bytes())),
               "use an EXR or a 16-bit PNG image, or a mesh as glTF, GLB or OBJ")
      .in_file(path);
}

}  // namespace

Ground open_terrain(const std::string& ground, const height_field::Placement& placement,
                    Inputs& inputs) {
  std::error_code ignored;
  const bool is_file = ground == "-" || std::filesystem::exists(ground, ignored);
  if (!terrain::is_spec(ground) || is_file) {
    if (is_file || !extension(ground).empty()) return open_ground_file(ground, placement, inputs);
  } else if (placement.size || placement.range || placement.centre) {
    return Error("usage", "size and range of the ground are for height fields (EXR, PNG)");
  }
  auto made = terrain::from_spec(ground);
  if (!made && made.error().code == "ground-kind") {
    made.error().hint =
        fmt::format("{}{} ground is a file, or {}", made.error().hint,
                    made.error().hint.ends_with('?') ? "" : ";", terrain::kSpecForms);
  }
  return made;
}

}  // namespace krok::io
