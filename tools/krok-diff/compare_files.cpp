#include "tools/krok-diff/compare_files.h"

#include <fmt/format.h>
#include <algorithm>

#include "compare/clip_difference.h"
#include "compare/model_difference.h"
#include "core/numbers.h"
#include "formats/cam/cam.h"
#include "formats/io/formats.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/registry/registry.h"
#include "skin/scene_of.h"

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

// Files from this size on are compared block by block.
constexpr std::size_t kLongFile = std::size_t{64} << 20;

void add_rows(const Skeleton& skeleton, const compare::ClipDifference& found, Outcome& outcome) {
  outcome.kind = word_of(InputKind::motion);
  outcome.summary = {fmt::format("motions: {}, {} compared",
                                 counted(skeleton.joint_count(), "joint"),
                                 counted(found.compared_frames, "frame"))};
  outcome.structure = found.structure;
  outcome.notes = found.notes;
  outcome.names.joints = skeleton.names;
  outcome.add_row("reference positions", Unit::length, found.reference_positions);
  outcome.add_row("reference orientations", Unit::angle, found.reference_orientations);
  outcome.add_row("positions", Unit::length, found.positions);
  outcome.add_row("orientations", Unit::angle, found.orientations);
  outcome.add_row("stretches", Unit::ratio, found.stretches);
  outcome.add_joints(found.joints);
  outcome.same = found.same();
}

// Without either motion in memory as a whole.
Result<Outcome> compare_long_motions(const InputFile& first, const InputFile& second,
                                     const Options& options, ToolContext& context) {
  std::optional<Result<compare::ClipDifference>> found;
  Stretches stretches[2];
  const auto facts = io::stream_motion(
      first, context,
      [&](const FrameSource& a) -> Status {
        const auto other = io::stream_motion(
            second, context,
            [&](const FrameSource& b) -> Status {
              FrameSource counted_frames = a;
              counted_frames.read = [&](int from, int count, std::span<Vec3f> positions,
                                        std::span<Quatf> orientations) {
                context.progress->advance(static_cast<std::uint64_t>(count));
                return a.read(from, count, positions, orientations);
              };
              context.progress->begin("comparing frames",
                                      static_cast<std::uint64_t>(a.frame_count));
              found = compare::difference(counted_frames, b, options.tolerance, options.matching,
                                          stretches[0], stretches[1], context.jobs);
              context.progress->end();
              return *found ? Status() : Status(found->error());
            },
            {.stretches = &stretches[1]});
        return other ? Status() : Status(other.error());
      },
      {.stretches = &stretches[0]});
  if (!facts) return facts.error();
  Outcome outcome;
  add_rows(facts->skeleton, **found, outcome);
  return outcome;
}

using registry::Kind;

struct KindRow {
  InputKind kind;
  const char* description;
  const char* word;
};
constexpr KindRow kKindRows[] = {{InputKind::motion, "a motion", "anim"},
                                 {InputKind::model, "a model (.model)", "model"},
                                 {InputKind::mesh, "a mesh (.obj)", "obj"},
                                 {InputKind::camera, "a camera (.cam)", "cam"},
                                 {InputKind::gltf, "glTF", "gltf"},
                                 {InputKind::points, "a point cache (.pc2)", "pc2"},
                                 {InputKind::morphs, "morph targets (.exr)", "morphs"}};

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
  outcome.summary = {fmt::format(
      "models: {}, {}, {}", counted(model.vertex_count(), "vertex", "vertices"),
      counted(model.triangles.size(), "triangle"), counted(model.skeleton.joint_count(), "joint"))};
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

Result<Outcome> compare_motions(const InputFile& first, const InputFile& second,
                                const Options& options, ToolContext& context) {
  const bool drawn = !options.sheet.path.empty() || !options.plot.empty() || options.has_page();
  if (!drawn && first.bytes().size() + second.bytes().size() >= kLongFile) {
    return compare_long_motions(first, second, options, context);
  }
  std::vector<Stretches> stretches;
  auto clips = read_both<Clip>(first, second, [&](const InputFile& file) {
    return io::open_motion(file, context, {.stretches = &stretches.emplace_back()});
  });
  if (!clips) return clips.error();
  const auto found = compare::difference(clips->first, clips->second, options.tolerance,
                                         options.matching, stretches[0], stretches[1]);
  if (!found) return found.error();
  Outcome outcome;
  const Status status = draw(
      options, context, found->same(),
      [&] { return sheet_of(clips->first, clips->second, found->positions); }, outcome.pictures);
  if (!status) return status.error();
  const auto [first_name, second_name] = image_names(options);
  const PlottedClip a{first_name, &clips->first};
  const PlottedClip b{second_name, &clips->second};
  const Status step = plot(
      options, context, found->same(), [&] { return plot_of(a, b, *found); }, outcome.chart);
  if (!step) return step.error();
  add_rows(clips->first.skeleton, *found, outcome);
  return outcome;
}

Result<Outcome> compare_cameras(const InputFile& first, const InputFile& second,
                                const Options& options) {
  auto cameras = read_both<CameraTrack>(
      first, second, [](const InputFile& file) { return cam::read(file.bytes()); });
  if (!cameras) return cameras.error();
  const auto found = compare::difference(cameras->first, cameras->second, options.tolerance);
  if (!found) return found.error();
  Outcome outcome;
  outcome.kind = word_of(InputKind::camera);
  outcome.summary = {fmt::format("cameras: {} compared", counted(found->compared_frames, "frame"))};
  outcome.structure = found->structure;
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("orientations", Unit::angle, found->orientations);
  outcome.add_row("fields of view", Unit::angle, found->fields_of_view);
  outcome.same = found->same();
  return outcome;
}

std::string description(InputKind kind) {
  return std::ranges::find(kKindRows, kind, &KindRow::kind)->description;
}

const char* word_of(InputKind kind) {
  return std::ranges::find(kKindRows, kind, &KindRow::kind)->word;
}

Result<InputKind> kind_of(const InputFile& file) {
  if (file.text().starts_with("\x76\x2F\x31\x01")) return InputKind::morphs;
  if (file.text().starts_with("POINTCACHE2")) return InputKind::points;
  if (extension(file.path()) == ".obj") return InputKind::mesh;
  const auto bytes = file.bytes();
  if (io::is_motion(file)) return InputKind::motion;
  const Kind kind = registry::identify(file.path(), bytes);
  switch (kind) {
    case Kind::model:
      return InputKind::model;
    case Kind::cam:
      return InputKind::camera;
    case Kind::glb:
    case Kind::gltf:
      return InputKind::gltf;
    default:
      break;
  }
  return Error("diff-kind",
               fmt::format(
                   "this is {}; expected a motion (.anim, .bvh, .amc), .model, .cam, .glb, .gltf, "
                   ".obj, .pc2 or .exr file",
                   registry::describe_content(bytes)),
               registry::advice(kind, Kind::anim))
      .in_file(file.path());
}

}  // namespace krok::cli::diff
