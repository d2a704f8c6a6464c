#include <fmt/format.h>

#include "compare/model_difference.h"
#include "compare/morph_difference.h"
#include "core/numbers.h"
#include "formats/io/open_character.h"
#include "formats/morph_exr/morph_exr.h"
#include "skin/scene_of.h"
#include "tools/krok-diff/compare_two.h"
#include "tools/krok-diff/comparisons.h"
#include "tools/krok-diff/heatmap.h"

namespace krok::cli::diff {

Result<Outcome> compare_models(const InputFile& first, const InputFile& second,
                               const Options& options, ToolContext& context) {
  auto actors = read_both<Actor>(
      first, second, [&](const InputFile& file) { return io::open_actor(file, context); });
  if (!actors) return actors.error();
  const auto before = std::make_shared<const Actor>(std::move(actors->first));
  const auto after = std::make_shared<const Actor>(std::move(actors->second));
  const Model& model = before->model;
  const auto found = compare::difference(model, after->model, options.tolerance, options.matching);
  if (!found) return found.error();
  const Scene a = scene_of(before), b = scene_of(after);
  Outcome outcome;
  const Status status = draw(
      options, context, found->same(),
      [&] { return sheet_of(a, b, found->positions, compare::Matching::order, false); },
      outcome.pictures);
  if (!status) return status.error();
  if (!options.heatmap.empty()) {
    const compare::SceneOptions how{options.tolerance, options.matching};
    const Status step = write_heatmap(a, b, how, options.heatmap, context);
    if (!step) return step.error();
  }
  outcome.kind = word_of(InputKind::model);
  outcome.summary = {
      fmt::format("models: {}, {}, {}", counted(model.vertex_count(), "vertex", "vertices"),
                  counted(static_cast<std::int64_t>(model.triangles.size()), "triangle"),
                  counted(model.skeleton.joint_count(), "joint"))};
  outcome.structure = found->structure;
  outcome.names.joints = model.skeleton.names;
  outcome.add_row("joint positions", Unit::length, found->reference_positions);
  outcome.add_row("joint orientations", Unit::angle, found->reference_orientations);
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("normals", Unit::angle, found->normals);
  outcome.add_row("texture coordinates", Unit::ratio, found->texture_coordinates);
  outcome.add_row("vertex colours", Unit::ratio, found->colours);
  outcome.add_tangents(found->tangents, found->tangent_sides);
  outcome.add_row("weights", Unit::ratio, found->weights);
  outcome.add_joints(found->joints);
  outcome.same = found->same();
  return outcome;
}

Result<Outcome> compare_morphs(const InputFile& first, const InputFile& second,
                               const Options& options) {
  auto morphs = read_both<MorphSet>(
      first, second, [](const InputFile& file) { return morph_exr::read(file.bytes()); });
  if (!morphs) return morphs.error();
  const auto found =
      compare::difference(morphs->first, morphs->second, options.tolerance, options.matching);
  if (!found) return found.error();
  Outcome outcome;
  outcome.kind = word_of(InputKind::morphs);
  outcome.summary = {fmt::format("morph targets: {}, {} compared",
                                 counted(morphs->first.vertex_count, "vertex", "vertices"),
                                 counted(found->compared_targets, "target"))};
  outcome.structure = found->structure;
  outcome.names.targets = {morphs->first.names};
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("normals", Unit::angle, found->normals);
  outcome.same = found->same();
  return outcome;
}

}  // namespace krok::cli::diff
