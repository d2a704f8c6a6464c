#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "capture/unique_names.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/model/model_format.h"
#include "formats/obj/obj_writer.h"
#include "skin/surface_normals.h"
#include "tools/cli/file_name.h"
#include "tools/cli/output_set.h"
#include "tools/krok-morph/options.h"
#include "tools/krok-morph/shape_file.h"

// Unpacks morph targets, one file each.

namespace krok::cli::morph {

namespace {

Result<std::vector<int>> chosen_targets(const Options& options, const MorphSet& morphs) {
  std::vector<int> chosen;
  for (const std::string& name : options.targets) {
    const int target = morphs.find(name);
    if (target < 0) {
      const std::string nearest = nearest_name(name, morphs.names);
      return Error("morph-target", fmt::format("there is no target '{}'", shown(name)),
                   nearest.empty() ? "list them with krok-morph info"
                                   : fmt::format("did you mean '{}'?", shown(nearest)))
          .in_file(options.files[0]);
    }
    if (std::ranges::find(chosen, target) == chosen.end()) chosen.push_back(target);
  }
  for (int t = 0; options.targets.empty() && t < morphs.target_count(); ++t) chosen.push_back(t);
  return chosen;
}

ShapeFormat format_of(const Options& options, const ShapeFile& base) {
  if (options.format != ShapeFormat::as_base) return options.format;
  constexpr std::array kFormats = {ShapeFormat::obj, ShapeFormat::glb,
                                   ShapeFormat::model};  // [Source]
  return kFormats[static_cast<std::size_t>(base.source)];
}

const char* ending_of(ShapeFormat format) {
  return format == ShapeFormat::obj ? ".obj" : format == ShapeFormat::glb ? ".glb" : ".model";
}

// The base's mesh in the shape of a target.
Model model_of(const ShapeFile& base, const MorphSet& morphs, int target) {
  Model model = base.model;
  const auto positions = morphs.target_positions(target);
  const auto normals = morphs.target_normals(target);
  model.positions.assign(positions.begin(), positions.end());
  if (normals.empty()) {
    moved_normals(model.triangles, base.model.positions, base.model.normals, positions,
                  model.normals);
    return model;
  }
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const double length = normals[v].cast<double>().norm();
    if (std::abs(length - 1) < 1e-6) {
      model.normals[v] = normals[v];
    } else if (length > 1e-6) {
      model.normals[v] = (normals[v].cast<double>() / length).cast<float>();
    }
  }
  return model;
}

// Converts back to the unit and axes of OBJ files.
void to_obj_space(const Options& options, Model& model) {
  const auto turned = [&](const Vec3f& vector) -> Vec3f {
    return options.up == Up::z ? Vec3f(vector.x(), -vector.z(), vector.y()) : vector;
  };
  for (Vec3f& normal : model.normals) normal = turned(normal);
  for (Vec3f& position : model.positions) {
    const Vec3 scaled = turned(position).cast<double>() / options.unit.metres;
    position = scaled.cast<float>();
  }
}

Status write_shape(Model model, const std::string& name, ShapeFormat format, const Options& options,
                   const ToolContext& context, OutputFile& file) {
  model.provenance = context.provenance();
  if (format == ShapeFormat::model) return model::write(model, {}, file);
  if (format == ShapeFormat::obj) {
    to_obj_space(options, model);
    obj::WriteOptions writing;
    writing.provenance = model.provenance;
    writing.name = name;
    return obj::write(model, {model.positions, model.normals, {}}, writing, file);
  }
  // Readers treat each primitive as separate vertices; a single one keeps one list.
  model.parts = {{name, {}, 0, static_cast<std::uint32_t>(model.triangles.size())}};
  gltf::WriteOptions writing;
  writing.provenance = model.provenance;
  writing.name = name;
  return gltf::write_mesh(model, {model.positions, model.normals, {}}, writing, file);
}

}  // namespace

Result<int> unpack(const Options& options, ToolContext& context) {
  const auto targets = read_targets(options.files[0], context);
  if (!targets) return targets.error();
  const MorphSet& morphs = targets->morphs;
  const auto base = read_shape(options.files[1], options, context);
  if (!base) return base.error();
  if (Status status = check_vertices(*base, morphs, options.files[0]); !status)
    return status.error();
  const auto chosen = chosen_targets(options, morphs);
  if (!chosen) return chosen.error();

  std::error_code failed;
  std::filesystem::create_directories(options.out_dir, failed);
  if (failed) {
    return Error("file-unwritable", "cannot create folder: " + failed.message())
        .in_file(options.out_dir);
  }
  const ShapeFormat format = format_of(options, *base);
  UniqueNames file_names;
  std::vector<std::string> paths;
  for (const int target : *chosen) {
    const std::string& name = morphs.names[static_cast<std::size_t>(target)];
    const std::string file_name = file_names.make(file_name_of(name)) + ending_of(format);
    paths.push_back((std::filesystem::path(options.out_dir) / file_name).string());
  }
  OutputSet outputs(context);
  const auto write = [&](std::size_t i, OutputFile& file) {
    const int target = (*chosen)[i];
    return write_shape(model_of(*base, morphs, target),
                       morphs.names[static_cast<std::size_t>(target)], format, options, context,
                       file);
  };
  if (Status status = outputs.add_all(paths, context.jobs, write); !status) return status.error();
  if (Status status = outputs.finish(); !status) return status.error();
  Json list = Json::array();
  for (std::size_t i = 0; i < paths.size(); ++i) {
    list.push_back(
        {{"name", morphs.names[static_cast<std::size_t>((*chosen)[i])]}, {"file", paths[i]}});
  }
  context.report.result["targets"] = std::move(list);
  context.log(fmt::format("{}: {} of {}", options.out_dir, counted(paths.size(), "shape"),
                          counted(morphs.vertex_count, "vertex", "vertices")));
  return kExitDone;
}

}  // namespace krok::cli::morph
