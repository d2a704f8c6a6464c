#include <fmt/format.h>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/morph_exr/morph_exr.h"
#include "tools/cli/output_set.h"
#include "tools/krok-morph/motion_file.h"
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
    return Error("morph-format", "pack writes .exr files").in_file(context.output);
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

}  // namespace krok::cli::morph
