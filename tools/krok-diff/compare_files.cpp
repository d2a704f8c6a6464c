#include "compare_files.h"

#include <fmt/format.h>

#include "compare/camera_difference.h"
#include "compare/clip_difference.h"
#include "compare/model_difference.h"
#include "compare/scene_difference.h"
#include "core/numbers.h"
#include "difference_plot.h"
#include "formats/anim/anim.h"
#include "formats/cam/cam.h"
#include "formats/model/model_format.h"
#include "formats/registry/registry.h"
#include "gltf_scene.h"
#include "tools/common/gltf/gltf_input.h"

namespace krok::diff {

namespace {

using registry::Kind;

// GLB and glTF in JSON are one kind here.
Kind comparable(Kind kind) {
  return kind == Kind::glb ? Kind::gltf : kind;
}

std::string description(Kind kind) {
  switch (kind) {
    case Kind::anim:
      return "a motion (.anim)";
    case Kind::model:
      return "a model (.model)";
    case Kind::cam:
      return "a camera (.cam)";
    case Kind::gltf:
      return "glTF";
    default:
      return "something else";
  }
}

Result<Kind> kind_of(const std::string& path, const InputFile& file) {
  const Kind kind = comparable(registry::identify(path, file.bytes()));
  if (kind == Kind::anim || kind == Kind::model || kind == Kind::cam || kind == Kind::gltf) {
    return kind;
  }
  return Error("diff-kind",
               fmt::format("this is {}; .anim, .model, .cam, .glb and .gltf files can be compared",
                           registry::describe_content(file.bytes())),
               registry::advice(kind, Kind::anim))
      .in_file(path);
}

// Both files read by the same reader, errors with the file's path.
template <typename T, typename Read>
Result<std::pair<T, T>> read_both(const InputFile& first, const InputFile& second, Read read) {
  Result<T> a = read(first);
  if (!a) return std::move(a.error()).in_file(first.path());
  Result<T> b = read(second);
  if (!b) return std::move(b.error()).in_file(second.path());
  return std::pair<T, T>(std::move(*a), std::move(*b));
}

// Draws the sheet of two things, where one is wanted.
template <typename T>
Status draw_sheet(const T& first, const T& second, const compare::Measure& found,
                  const Options& options, ToolContext& context) {
  if (options.sheet.path.empty()) return {};
  DifferenceSheet sheet = sheet_of(first, second, found);
  sheet.first_name = base_name(options.first);
  sheet.second_name = base_name(options.second);
  return write_sheet(sheet, options.sheet, context);
}

Result<Outcome> compare_clips(const InputFile& first, const InputFile& second,
                              const Options& options, ToolContext& context) {
  auto clips = read_both<Clip>(first, second,
                               [](const InputFile& file) { return anim::read(file.bytes()); });
  if (!clips) return clips.error();
  const auto found = compare::difference(clips->first, clips->second, options.tolerance);
  if (!found) return found.error();
  if (Status drawn = draw_sheet(clips->first, clips->second, found->positions, options, context);
      !drawn) {
    return drawn.error();
  }
  if (!options.plot.empty()) {
    const PlottedClip a{base_name(options.first), &clips->first};
    const PlottedClip b{base_name(options.second), &clips->second};
    if (Status drawn = write_plot(a, b, options.plot, context); !drawn) return drawn.error();
  }
  Outcome outcome;
  outcome.kind = "anim";
  outcome.summary = {fmt::format("motions: {}, {} compared",
                                 counted(clips->first.joint_count(), "joint", "joints"),
                                 counted(found->compared_frames, "frame", "frames"))};
  outcome.structure = found->structure;
  outcome.names.joints = clips->first.skeleton.names;
  outcome.add_row("reference positions", Unit::length, found->reference_positions);
  outcome.add_row("reference orientations", Unit::angle, found->reference_orientations);
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("orientations", Unit::angle, found->orientations);
  outcome.same = found->same();
  return outcome;
}

Result<Outcome> compare_models(const InputFile& first, const InputFile& second,
                               const Options& options, ToolContext& context) {
  auto models = read_both<Model>(first, second,
                                 [](const InputFile& file) { return model::read(file.bytes()); });
  if (!models) return models.error();
  const auto found = compare::difference(models->first, models->second, options.tolerance);
  if (!found) return found.error();
  if (Status drawn = draw_sheet(models->first, models->second, found->positions, options, context);
      !drawn) {
    return drawn.error();
  }
  Outcome outcome;
  outcome.kind = "model";
  outcome.summary = {fmt::format(
      "models: {}, {}, {}", counted(models->first.vertex_count(), "vertex", "vertices"),
      counted(static_cast<std::int64_t>(models->first.triangles.size()), "triangle", "triangles"),
      counted(models->first.skeleton.joint_count(), "joint", "joints"))};
  outcome.structure = found->structure;
  outcome.names.joints = models->first.skeleton.names;
  outcome.add_row("joint positions", Unit::length, found->reference_positions);
  outcome.add_row("joint orientations", Unit::angle, found->reference_orientations);
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("normals", Unit::angle, found->normals);
  outcome.add_row("texture coordinates", Unit::ratio, found->texture_coordinates);
  outcome.add_row("tangents", Unit::angle, found->tangents);
  outcome.add_row("weights", Unit::ratio, found->weights);
  outcome.same = found->same();
  return outcome;
}

Result<Outcome> compare_cameras(const InputFile& first, const InputFile& second,
                                const compare::Tolerance& tolerance) {
  auto cameras = read_both<CameraTrack>(
      first, second, [](const InputFile& file) { return cam::read(file.bytes()); });
  if (!cameras) return cameras.error();
  const auto found = compare::difference(cameras->first, cameras->second, tolerance);
  if (!found) return found.error();
  Outcome outcome;
  outcome.kind = "cam";
  outcome.summary = {
      fmt::format("cameras: {} compared", counted(found->compared_frames, "frame", "frames"))};
  outcome.structure = found->structure;
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("orientations", Unit::angle, found->orientations);
  outcome.add_row("fields of view", Unit::angle, found->fields_of_view);
  outcome.same = found->same();
  return outcome;
}

Result<Outcome> compare_gltf(const InputFile& first, const InputFile& second,
                             const Options& options, ToolContext& context) {
  auto assets = read_both<nodes::Scene>(
      first, second, [&](const InputFile& file) { return read_gltf(file, context); });
  if (!assets) return assets.error();
  context.tell(assets->first.diagnostics);
  context.tell(assets->second.diagnostics);
  const auto a = scene_of(assets->first);
  if (!a) return Error(a.error()).in_file(first.path());
  const auto b = scene_of(assets->second);
  if (!b) return Error(b.error()).in_file(second.path());
  const auto found =
      compare::difference(*a, *b, options.tolerance, context.jobs, *context.progress);
  if (!found) return found.error();
  const bool bare = a->meshes.empty() || b->meshes.empty();
  if (Status drawn =
          draw_sheet(*a, *b, bare ? found->joint_positions : found->positions, options, context);
      !drawn) {
    return drawn.error();
  }

  Outcome outcome;
  outcome.kind = "gltf";
  const std::string first_summary = summary_of(*a);
  const std::string second_summary = summary_of(*b);
  outcome.summary = {"glTF: " + first_summary};
  if (second_summary != first_summary) outcome.summary.push_back("against " + second_summary);
  if (a->animations.empty() || b->animations.empty()) {
    outcome.summary.push_back("compared without animation");
  } else {
    outcome.summary.push_back(
        fmt::format("compared at {}", counted(found->compared_times, "moment", "moments")));
  }
  outcome.structure = found->structure;
  outcome.notes = found->notes;
  outcome.names.joints = a->joint_names;
  for (const compare::SceneMesh& mesh : a->meshes) {
    outcome.names.meshes.push_back(mesh.name);
    auto& targets = outcome.names.targets.emplace_back();
    for (const auto& target : mesh.targets) targets.push_back(target.name);
  }
  for (const auto& animation : a->animations) outcome.names.animations.push_back(animation.name);
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("normals", Unit::angle, found->normals);
  outcome.add_row("joint positions", Unit::length, found->joint_positions);
  outcome.add_row("joint orientations", Unit::angle, found->joint_orientations);
  outcome.add_row("morph targets", Unit::length, found->target_positions);
  outcome.add_row("morph targets' normals", Unit::ratio, found->target_normals);
  outcome.add_row("texture coordinates", Unit::ratio, found->texture_coordinates);
  outcome.add_row("weights", Unit::ratio, found->weights);
  outcome.same = found->same();
  return outcome;
}

}  // namespace

Result<Outcome> compare_files(const Options& options, ToolContext& context) {
  auto first = context.open_input(options.first);
  if (!first) return first.error();
  auto second = context.open_input(options.second);
  if (!second) return second.error();
  const auto first_kind = kind_of(options.first, *first);
  if (!first_kind) return first_kind.error();
  const auto second_kind = kind_of(options.second, *second);
  if (!second_kind) return second_kind.error();
  if (*first_kind != *second_kind) {
    return Error("diff-kinds",
                 fmt::format("{} is {}, but {} is {}", options.first, description(*first_kind),
                             options.second, description(*second_kind)),
                 "compare two files of one kind; krok-export and krok-skin make glTF of a motion");
  }
  if (!options.plot.empty() && *first_kind != Kind::anim) {
    return Error("usage", "--plot shows motions (.anim) over time",
                 "--sheet shows models and glTF files too");
  }
  if (!options.sheet.path.empty() && *first_kind == Kind::cam) {
    return Error("usage", "--sheet shows figures, and cameras have none");
  }
  switch (*first_kind) {
    case Kind::anim:
      return compare_clips(*first, *second, options, context);
    case Kind::model:
      return compare_models(*first, *second, options, context);
    case Kind::cam:
      return compare_cameras(*first, *second, options.tolerance);
    default:
      return compare_gltf(*first, *second, options, context);
  }
}

}  // namespace krok::diff
