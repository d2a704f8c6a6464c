#include "tools/krok-diff/compare_files.h"

#include <fmt/format.h>

#include "tools/krok-diff/comparisons.h"
#include "tools/krok-diff/input_kinds.h"

namespace krok::cli::diff {

namespace {

// Whether two file types can be compared as scenes.
bool are_scenes(InputKind first, InputKind second) {
  const auto either = [&](InputKind kind) { return first == kind || second == kind; };
  if (either(InputKind::camera) || either(InputKind::morphs)) return false;
  // A motion has only animated joints, a model only a static mesh.
  const bool joints_alone = either(InputKind::motion);
  return !(joints_alone &&
           (either(InputKind::model) || either(InputKind::mesh) || either(InputKind::points)));
}

Status check_drawings(const Options& options, InputKind first, InputKind second) {
  const auto either = [&](InputKind kind) { return first == kind || second == kind; };
  const auto stands = [&](InputKind kind) {
    return kind == InputKind::camera || kind == InputKind::morphs || kind == InputKind::model ||
           kind == InputKind::mesh;
  };
  if (!options.plot.empty() && (stands(first) || stands(second))) {
    return Error("usage", "--plot is for motions and glTF", "use --sheet or --heatmap for models");
  }
  const auto has_mesh = [](InputKind kind) {
    return kind == InputKind::gltf || kind == InputKind::model || kind == InputKind::mesh ||
           kind == InputKind::points;
  };
  if (!options.heatmap.empty() && !(has_mesh(first) && has_mesh(second))) {
    return Error("usage", "--heatmap is for glTF, models and point caches",
                 "use --sheet for motions");
  }
  if (options.sheet.path.empty()) return {};
  if (either(InputKind::camera)) {
    return Error("usage", "--sheet is not for cameras");
  }
  if (either(InputKind::morphs) || either(InputKind::points)) {
    return Error("usage",
                 "--sheet needs triangles, which morph targets and point caches do not have");
  }
  return {};
}

Result<Outcome> compare_kinds(const InputFile& first, InputKind first_kind, const InputFile& second,
                              InputKind second_kind, const Options& options, ToolContext& context) {
  if (first_kind == second_kind) {
    switch (first_kind) {
      case InputKind::motion:
        return compare_motions(first, second, options, context);
      case InputKind::camera:
        return compare_cameras(first, second, options);
      case InputKind::morphs:
        return compare_morphs(first, second, options);
      case InputKind::model:
        if (options.matching == compare::Matching::nearest) break;
        return compare_models(first, second, options, context);
      default:
        break;
    }
  }
  return compare_scenes(first, first_kind, second, second_kind, options, context);
}

// Options that these files leave without an effect.
void add_notes(const Options& options, InputKind first, InputKind second, Outcome& outcome) {
  if (options.materials && !(first == InputKind::gltf && second == InputKind::gltf)) {
    outcome.notes.emplace_back("--materials has no effect: only glTF files have materials");
  }
  const auto has_mesh = [](InputKind kind) {
    return kind == InputKind::gltf || kind == InputKind::model || kind == InputKind::mesh ||
           kind == InputKind::points;
  };
  if (options.matching == compare::Matching::nearest && !(has_mesh(first) && has_mesh(second))) {
    outcome.notes.emplace_back("--match nearest has no effect: the files have no meshes to match");
  }
}

}  // namespace

Result<Outcome> compare_files(const Options& options, ToolContext& context) {
  auto first = context.open_input(options.first);
  if (!first) return first.error();
  auto second = context.open_input(options.second);
  if (!second) return second.error();
  const auto first_kind = kind_of(*first);
  if (!first_kind) return first_kind.error();
  const auto second_kind = kind_of(*second);
  if (!second_kind) return second_kind.error();
  if (*first_kind != *second_kind && !are_scenes(*first_kind, *second_kind)) {
    return Error("diff-kinds",
                 fmt::format("{} is {}, but {} is {}", options.first, description(*first_kind),
                             options.second, description(*second_kind)),
                 "compare two files of the same type, or glTF with a motion, a model, a mesh or a "
                 "point cache");
  }
  if (Status status = check_drawings(options, *first_kind, *second_kind); !status)
    return status.error();
  auto outcome = compare_kinds(*first, *first_kind, *second, *second_kind, options, context);
  if (outcome) add_notes(options, *first_kind, *second_kind, *outcome);
  return outcome;
}

}  // namespace krok::cli::diff
