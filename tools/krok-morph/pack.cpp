#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "capture/unique_names.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/obj/obj_writer.h"
#include "formats/registry/registry.h"
#include "skin/surface_normals.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/krok-morph/options.h"
#include "tools/krok-morph/shape_file.h"

// Packs shapes into an .exr of morph targets.

namespace krok::cli::morph {

namespace {

constexpr std::size_t kMaxTargetVertices = 50'000'000;  // of all targets together

// "smile" for "shapes/smile.obj".
std::string name_of(const std::string& path) {
  const std::string name = base_name(path);
  return to_utf8(name.substr(0, name.size() - extension(name).size()));
}

Status check_name(const std::string& name, const MorphSet& morphs, const std::string& path) {
  if (name.empty() || !is_utf8(name)) {
    return Error("morph-name", "a target's name is empty or not UTF-8", "set another with --name")
        .in_file(path);
  }
  if (morphs.find(name) < 0) return {};
  return Error("morph-name", fmt::format("duplicate target name {}", shown(name)),
               "give each target its own --name")
      .in_file(path);
}

Status add_target(const ShapeFile& base, const std::string& path, const std::string& name,
                  const Options& options, ToolContext& context, MorphSet& morphs) {
  const auto shape = read_shape(path, options, context);
  if (!shape) return shape.error();
  if (Status status = check_same_mesh(base, *shape, options); !status) return status;
  if (Status status = check_name(name, morphs, path); !status) return status;
  const std::vector<Vec3f>& positions = shape->model.positions;
  if (morphs.positions.size() + positions.size() > kMaxTargetVertices) {
    return Error("morph-too-large", fmt::format("the targets have more than {} vertices in total",
                                                grouped(kMaxTargetVertices)))
        .in_file(path);
  }
  morphs.names.push_back(name);
  morphs.positions.insert(morphs.positions.end(), positions.begin(), positions.end());
  const std::vector<Vec3f> normals = normals_for(base, *shape);
  morphs.normals.insert(morphs.normals.end(), normals.begin(), normals.end());
  return {};
}

Json report_targets(const ShapeFile& base, const MorphSet& morphs, ToolContext& context) {
  Json list = Json::array();
  for (int t = 0; t < morphs.target_count(); ++t) {
    const Movement movement = movement_of(base.model.positions, morphs.target_positions(t));
    const std::string& name = morphs.names[static_cast<std::size_t>(t)];
    Json one;
    one["name"] = name;
    one.update(to_json(movement));
    list.push_back(std::move(one));
    context.log(fmt::format("  {}: {}", shown(name), describe(movement)));
    if (movement.moved > 0) continue;
    context.warn("morph-still", fmt::format("target {} is identical to the base", shown(name)));
  }
  return list;
}

}  // namespace

Result<int> pack(const Options& options, ToolContext& context) {
  const std::string end = extension(context.output);
  if (end != ".exr" && context.output != "-") {
    return Error("morph-format", "pack writes .exr files",
                 "write -o OUT.exr; krok-skin --morph reads it")
        .in_file(context.output);
  }
  const bool alone = options.files.size() == 1;
  auto base = read_shape(options.files[0], options, context, true);
  if (!base) return base.error();
  MorphSet morphs = std::move(base->morphs);
  morphs.vertex_count = base->model.vertex_count();
  if (alone && morphs.names.empty()) {
    return Error("morph-target",
                 base->source == Source::gltf ? "the file has no morph targets"
                                              : "such files cannot have targets",
                 "add the target files after it")
        .in_file(base->path);
  }
  for (std::size_t i = 1; i < options.files.size(); ++i) {
    const std::string& path = options.files[i];
    const std::string name = options.names.empty() ? name_of(path) : options.names[i - 1];
    if (Status status = add_target(*base, path, name, options, context, morphs); !status) {
      return status.error();
    }
  }
  morphs.provenance = context.provenance();
  const Status status = write_output(
      context, context.output, [&](OutputFile& file) { return morph_exr::write(morphs, file); });
  if (!status) return status.error();
  context.log(fmt::format("{}: {} of {}, as moved from {}", context.output,
                          counted(morphs.target_count(), "target"),
                          counted(morphs.vertex_count, "vertex", "vertices"), shown(base->path)));
  Json result;
  result["vertices"] = morphs.vertex_count;
  result["triangles"] = base->model.triangles.size();
  result["targets"] = report_targets(*base, morphs, context);
  context.report.result = std::move(result);
  return kExitDone;
}

// Unpacks morph targets, one file each.

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

// Describes an .exr of morph targets.

Result<TargetFile> read_targets(const std::string& path, ToolContext& context) {
  auto file = context.open_input(path);
  if (!file) return file.error();
  auto morphs = morph_exr::read(file->bytes());
  if (!morphs) {
    Error error = std::move(morphs).error();
    if (extension(path) != ".exr" && error.code == "exr-header") {
      error.message = fmt::format("is {}, not an .exr of morph targets",
                                  registry::describe_content(file->bytes()));
      error.hint =
          "krok-morph pack BASE TARGET... -o face.exr writes one; krok-info describes meshes";
    }
    return std::move(error).in_file(path);
  }
  return TargetFile{*std::move(file), *std::move(morphs)};
}

Result<int> info(const Options& options, ToolContext& context) {
  const auto targets = read_targets(options.files[0], context);
  if (!targets) return targets.error();
  const MorphSet& morphs = targets->morphs;
  const auto size = morph_exr::image_size(targets->file.bytes());
  if (!size) return Error(size.error()).in_file(options.files[0]);
  std::optional<ShapeFile> base;
  if (options.files.size() > 1) {
    auto read = read_shape(options.files[1], options, context);
    if (!read) return read.error();
    if (Status status = check_vertices(*read, morphs, options.files[0]); !status)
      return status.error();
    base = *std::move(read);
  }

  const bool normals = !morphs.normals.empty();
  std::string text = fmt::format("{} of {}, {}\n", counted(morphs.target_count(), "target"),
                                 counted(morphs.vertex_count, "vertex", "vertices"),
                                 normals ? "with normals" : "without normals");
  text += fmt::format("image of {} x {} texels: positions in rows 0 to {}, {} in rows {} to {}\n",
                      size->width, size->height, size->height / 2 - 1,
                      normals ? "normals" : "zeros", size->height / 2, size->height - 1);
  Json list = Json::array();
  for (int t = 0; t < morphs.target_count(); ++t) {
    Json one;
    one["name"] = morphs.names[static_cast<std::size_t>(t)];
    one["first_texel"] = static_cast<std::int64_t>(t) * morphs.vertex_count;
    std::string line = "  " + shown(morphs.names[static_cast<std::size_t>(t)]);
    if (base) {
      const Movement movement = movement_of(base->model.positions, morphs.target_positions(t));
      one.update(to_json(movement));
      line += ": " + describe(movement);
    }
    list.push_back(std::move(one));
    text += line + "\n";
  }
  Json result;
  result["vertices"] = morphs.vertex_count;
  result["normals"] = normals;
  result["picture"] = {{"width", size->width}, {"height", size->height}};
  result["targets"] = std::move(list);
  context.report.result = std::move(result);
  context.print(text);
  return kExitDone;
}

}  // namespace krok::cli::morph
