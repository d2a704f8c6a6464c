#include "tools/krok-import/scene_import.h"

#include <fmt/format.h>

#include "character/space.h"
#include "formats/io/open_scene.h"
#include "nodes/evaluate.h"
#include "tools/krok-import/scene_importer.h"

namespace krok::cli::import {

namespace {

Status check_options(const Options& options) {
  const auto for_captures = [](const char* option) {
    return Error("usage", fmt::format("{} is for captures (BVH, AMC)", option));
  };
  if (!options.skeleton.empty()) return for_captures("--skeleton");
  if (options.positions != bvh::Positions::automatic) return for_captures("--positions");
  if (options.angles != bvh::Angles::degrees) return for_captures("--angles");
  if (options.rest_frame != RestFrame::keep) return for_captures("--skip-rest-frame");
  if (options.repair) return for_captures("--repair");
  return {};
}

// With --strict, reader warnings are errors.
Status check_strict(const Options& options, const nodes::Scene& scene) {
  if (!options.strict) return {};
  for (const Diagnostic& diagnostic : scene.diagnostics) {
    if (diagnostic.severity != Severity::warning) continue;
    Error error(diagnostic);
    error.severity = Severity::error;
    error.hint = "without --strict this is a warning";
    return error;
  }
  return {};
}

}  // namespace

Result<int> import_scene(const InputFile& input, const Options& options, ToolContext& context) {
  if (Status status = check_options(options); !status) return status.error();
  auto how = read_options(options);
  if (!how) return how.error();
  auto scene = io::open_scene(input, context, !options.character.empty());
  if (!scene) return scene.error();
  if (Status status = check_strict(options, *scene); !status) {
    return std::move(status.error()).in_file(input.path());
  }
  if (!options.model.empty() || !options.character.empty()) {
    for (Diagnostic& diagnostic : scene->diagnostics) {
      if (diagnostic.code == "gltf-unread") diagnostic.severity = Severity::warning;
    }
  }
  context.diagnose(scene->diagnostics);
  // Axes from the user replace a rotation given by the file.
  if ((how->up || how->forward) && character::rotation_to_apply(scene->space) != Mat4::Identity()) {
    scene->space.file_to_krok.reset();
  }
  auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return std::move(evaluator.error()).in_file(input.path());
  return SceneImporter(input, options, *how, *scene, *evaluator, context).run();
}

}  // namespace krok::cli::import
