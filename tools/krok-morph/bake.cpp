#include <fmt/format.h>

#include "core/numbers.h"
#include "formats/weights/weights.h"
#include "skin/morph.h"
#include "tools/krok-morph/options.h"
#include "tools/krok-morph/shape_file.h"

// Bakes animated morph targets.

namespace krok::cli::morph {

namespace {

MeshMotion motion_of(const Model& model, const MorphSet& morphs, const MorphWeights& weights) {
  MeshMotion motion;
  motion.frames = weights.frame_count();
  motion.rate = weights.rate;
  motion.source = copies_of([&model, &morphs, &weights](int frame, const ShapeOutput& to) {
    const std::size_t targets = morphs.names.size();
    const auto at =
        std::span(weights.values).subspan(static_cast<std::size_t>(frame) * targets, targets);
    const std::span<const Vec3f> base =
        to.normals.empty() ? std::span<const Vec3f>() : std::span(model.normals);
    apply_morphs(morphs, at, {model.positions, base}, {to.positions, to.normals}, 1);
  });
  return motion;
}

Status check_as(const Options& options, MotionFormat format) {
  if (options.as != As::targets || format == MotionFormat::glb || format == MotionFormat::gltf) {
    return {};
  }
  return Error("usage", "--as targets is for glTF; a point cache has baked shapes");
}

// A weight that is always 0 was most likely forgotten, or misspelt in a table.
void report(const MorphWeights& weights, ToolContext& context) {
  const std::size_t targets = weights.names.size();
  Json list = Json::array();
  for (std::size_t t = 0; t < targets; ++t) {
    float least = weights.values[t], most = least;
    for (std::size_t i = t; i < weights.values.size(); i += targets) {
      least = std::min(least, weights.values[i]);
      most = std::max(most, weights.values[i]);
    }
    list.push_back({{"name", weights.names[t]}, {"smallest", least}, {"largest", most}});
  }
  Json result;
  result["frames"] = weights.frame_count();
  result["rate"] = weights.rate;
  result["targets"] = std::move(list);
  context.report.result = std::move(result);
}

}  // namespace

Result<int> bake(const Options& options, ToolContext& context) {
  const auto format = motion_format(context.output, false);
  if (!format) return format.error();
  if (Status status = check_as(options, *format); !status) return status.error();
  const auto targets = read_targets(options.files[0], context);
  if (!targets) return targets.error();
  const MorphSet& morphs = targets->morphs;
  const auto base = read_shape(options.files[1], options, context);
  if (!base) return base.error();
  if (Status status = check_vertices(*base, morphs, options.files[0]); !status)
    return status.error();
  const auto weights_file = context.open_input(options.weights);
  if (!weights_file) return weights_file.error();
  const auto given = weights::read(weights_file->text(), options.weights, morphs.names);
  if (!given) return given.error();
  const auto weights = weights::sampled(*given, options.weights, options.rate);
  if (!weights) return weights.error();
  if (auto warning = weights::implausible_weight(given->curves)) {
    context.diagnose_in(options.weights, {*std::move(warning)});
  }

  OutputSet outputs(context);
  const Status status =
      options.as == As::targets
          ? add_targets(*base, morphs, *weights, *format, outputs, context)
          : add_baked(*base, motion_of(base->model, morphs, *weights), *format, outputs, context);
  if (!status) return status.error();
  if (Status step = outputs.finish(); !step) return step.error();
  report(*weights, context);
  context.log(fmt::format("{}: {} at {} fps, {}", context.output,
                          counted(weights->frame_count(), "frame"), readable(weights->rate),
                          counted(morphs.target_count(), "target")));
  return kExitDone;
}

}  // namespace krok::cli::morph
