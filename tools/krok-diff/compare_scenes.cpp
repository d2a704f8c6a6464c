#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "compare/scene_difference.h"
#include "core/numbers.h"
#include "core/result.h"
#include "formats/image/decode_image.h"
#include "formats/io/open_character.h"
#include "formats/io/open_scene.h"
#include "formats/obj/obj_reader.h"
#include "formats/pc2/pc2.h"
#include "nodes/scene_of.h"
#include "scene/scene.h"
#include "skin/scene_of.h"
#include "tools/krok-diff/compare_files.h"
#include "tools/krok-diff/difference_sheet.h"

namespace krok::cli::diff {

namespace {

// Point caches as scenes, so that they can be compared with glTF and models.

constexpr double kSamplesPerSecond = 30;

// A time between two keys: `share` is the weight of the next key.
struct KeyInterval {
  std::size_t key = 0;
  double share = 0;
};

KeyInterval interval_of(double time, const std::vector<double>& times) {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {};
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end()) return {key, 0};
  return {key, (time - times[key]) / (*after - times[key])};
}

std::vector<double> frame_times(int frames, double rate) {
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(frames));
  for (int i = 0; i < frames; ++i) times.push_back(i / rate);
  return times;
}

template <typename From, typename To = Eigen::Matrix<double, From::RowsAtCompileTime, 1>>
std::vector<To> in_doubles(std::span<const From> values) {
  std::vector<To> result;
  result.reserve(values.size());
  for (const From& value : values) result.push_back(value.template cast<double>());
  return result;
}

// The range of points that belongs to each mesh.
struct Run {
  std::size_t begin = 0, count = 0;
};

std::vector<Run> runs_of(std::size_t points, const Scene* partner) {
  std::vector<Run> runs;
  if (partner != nullptr) {
    std::size_t begin = 0;
    bool each = !partner->meshes.empty();
    for (const SceneMesh& mesh : partner->meshes) {
      runs.push_back({begin, mesh.vertex_count});
      begin += mesh.vertex_count;
      each = each && mesh.vertex_count == points;
    }
    if (each) return std::vector<Run>(runs.size(), {0, points});
    if (begin == points) return runs;
  }
  return {{0, points}};
}

// Points only. A point cache has neither times nor meshes: samples are at the key times of
// `partner`'s first animation if the counts match, otherwise at 30 Hz. The cache must outlive the
// scene. The points are split among `partner`'s meshes in order if these have as many vertices in
// total, or used for each mesh if each has that many. Error (code pc2-value) for positions that are
// not finite.
Result<Scene> scene_of(const pc2::PointCache& points, const Scene* partner) {
  const auto count = static_cast<std::size_t>(points.points());
  if (points.samples() == 0) return Error("pc2-value", "the file has no samples");
  std::vector<Vec3f> sample(count);
  for (std::int64_t i = 0; i < points.samples(); ++i) {
    if (Status status = points.get(i, sample); !status) return status.error();
  }
  Scene scene;
  const std::vector<Run> runs = runs_of(count, partner);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SceneMesh mesh;
    mesh.only_points = true;
    mesh.vertex_count = runs[i].count;
    if (runs.size() > 1 && partner != nullptr) mesh.name = partner->meshes[i].name;
    scene.meshes.push_back(std::move(mesh));
  }
  const auto samples = static_cast<std::size_t>(points.samples());
  std::vector<double> times = frame_times(static_cast<int>(samples), kSamplesPerSecond);
  if (partner != nullptr && !partner->animations.empty() &&
      partner->animations.front().key_times.size() == samples) {
    times = partner->animations.front().key_times;
  }
  // A single sample is a static shape.
  if (samples != 1 || (partner != nullptr && !partner->animations.empty())) {
    scene.animations.push_back({"", times});
  }
  scene.evaluate = [&points, runs, times, count](int, double time, SceneState& state) {
    std::vector<Vec3f> one, next;
    const KeyInterval place = interval_of(time, times);
    // Cannot fail: all samples were validated before.
    const auto get = [&](std::size_t key, std::vector<Vec3f>& values) {
      values.resize(count);
      const Status status = points.get(static_cast<std::int64_t>(key), values);
      if (!status) values.assign(count, Vec3f::Zero());
    };
    get(place.key, one);
    if (place.share > 0) get(place.key + 1, next);
    state.positions.resize(runs.size());
    state.normals.assign(runs.size(), {});
    state.joints.clear();
    for (std::size_t m = 0; m < runs.size(); ++m) {
      const auto of_mesh = [&](const std::vector<Vec3f>& values) {
        return in_doubles(std::span(values).subspan(runs[m].begin, runs[m].count));
      };
      state.positions[m] = of_mesh(one);
      if (next.empty()) continue;
      const std::vector<Vec3> after = of_mesh(next);
      for (std::size_t i = 0; i < after.size(); ++i) {
        state.positions[m][i] += place.share * (after[i] - state.positions[m][i]);
      }
    }
  };
  return scene;
}

// A file as a scene.
struct Opened {
  InputKind kind = InputKind::gltf;
  std::optional<pc2::PointCache> points;
  Scene scene;

  // Reads the file, and builds the scene unless it depends on the partner's.
  Status read(const InputFile& file, ToolContext& context);
  Status read_gltf(const InputFile& file, ToolContext& context);
  // Builds the scene of a point cache, which depends on the partner's.
  Status finish(const Opened& partner);
};

Status Opened::read_gltf(const InputFile& file, ToolContext& context) {
  auto read = io::open_scene(file, context, true);
  if (!read) return std::move(read).error();
  for (const Diagnostic& diagnostic : read->diagnostics) {
    // What a Material leaves out is compared by its parameters.
    if (diagnostic.code != "gltf-material") context.diagnose(diagnostic);
  }
  // What is asked for by name may have another one in the other file.
  if (!file.part().empty()) read->animations[0].name.clear();
  auto made = scene_of(std::make_shared<const nodes::Scene>(*std::move(read)));
  if (!made) return std::move(made).error();
  scene = *std::move(made);
  if (!scene.not_compared.empty()) {
    context.warn("diff-not-compared", fmt::format("{}: not compared: {}", base_name(file.path()),
                                                  fmt::join(scene.not_compared, ", ")));
  }
  return {};
}

Status Opened::read(const InputFile& file, ToolContext& context) {
  if (kind == InputKind::gltf) return read_gltf(file, context);
  if (kind == InputKind::points) {
    auto read = pc2::PointCache::read(file.bytes());
    if (!read) return std::move(read).error();
    points = *read;
    return {};
  }
  if (kind == InputKind::mesh) {
    auto read = obj::read(file.text(), file.path());
    if (!read) return std::move(read).error();
    context.diagnose(read->diagnostics);
    Actor still;
    still.model = std::move(read->model);
    scene = scene_of(std::make_shared<const Actor>(std::move(still)));
    scene.joint_names.clear();  // the file has none
    scene.joint_parents.clear();
    return {};
  }
  auto actor = io::open_actor(file, context);
  if (!actor) return std::move(actor).error();
  Status status = kind == InputKind::model ? check(actor->model) : check(actor->motions[0].clip);
  if (status) scene = scene_of(std::make_shared<const Actor>(*std::move(actor)));
  return status;
}

Status Opened::finish(const Opened& partner) {
  if (!points) return {};
  auto made = scene_of(*points, partner.points ? nullptr : &partner.scene);
  if (!made) return std::move(made).error();
  scene = *std::move(made);
  return {};
}

// "1 mesh, 10,120 vertices, 20,236 triangles; 31 joints; 1 animation".
std::string summary_of(const Scene& scene) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const SceneMesh& mesh : scene.meshes) {
    vertices += mesh.vertex_count;
    triangles += mesh.triangles.size();
  }
  return fmt::format("{}, {}, {}; {}; {}", counted(scene.meshes.size(), "mesh", "meshes"),
                     counted(vertices, "vertex", "vertices"),
                     counted(triangles, "triangle", "triangles"),
                     counted(scene.joint_names.size(), "joint", "joints"),
                     counted(scene.animations.size(), "animation", "animations"));
}

PlaceNames names_of(const Scene& first, const Scene& second) {
  PlaceNames names;
  names.joints = first.joint_names;
  for (const SceneMesh& mesh : first.meshes) {
    names.meshes.push_back(mesh.name);
    names.first_files.emplace_back(mesh.node_name, mesh.mesh_name);
    auto& targets = names.targets.emplace_back();
    for (const auto& target : mesh.targets) targets.push_back(target.name);
  }
  for (const SceneMesh& mesh : second.meshes) {
    names.second_meshes.push_back(mesh.name);
    names.second_files.emplace_back(mesh.node_name, mesh.mesh_name);
  }
  for (const auto& animation : first.animations) names.animations.push_back(animation.name);
  return names;
}

std::vector<std::string> summary_lines(const Opened& first, const Opened& second, int moments) {
  const auto text = [](const Opened& one) {
    const char* kind = one.kind == InputKind::gltf     ? "glTF"
                       : one.kind == InputKind::model  ? "model"
                       : one.kind == InputKind::motion ? "motion"
                       : one.kind == InputKind::mesh   ? "mesh"
                                                       : "points";
    return fmt::format("{}: {}", kind, summary_of(one.scene));
  };
  std::vector<std::string> lines = {text(first)};
  if (text(second) != lines.front()) lines.push_back("against " + text(second));
  const bool moving = !first.scene.animations.empty() && !second.scene.animations.empty();
  lines.push_back(moving ? fmt::format("compared at {}", counted(moments, "time"))
                         : "compared without animation");
  return lines;
}

// Compares decoded pixels; each pair of images once.
compare::ImageDistance pixel_distance() {
  using Known =
      std::map<std::pair<const EncodedImage*, const EncodedImage*>, std::optional<double>>;
  return [known = std::make_shared<Known>()](const EncodedImage& first,
                                             const EncodedImage& second) -> std::optional<double> {
    const auto [place, added] = known->try_emplace({&first, &second});
    if (!added) return place->second;
    const auto a = image::decode(first.bytes), b = image::decode(second.bytes);
    if (!a || !b || a->width != b->width || a->height != b->height) return std::nullopt;
    int most = 0;
    for (std::size_t i = 0; i < a->rgba.size(); ++i) {
      most = std::max(most, std::abs(a->rgba[i] - b->rgba[i]));
    }
    place->second = most / 255.0;
    return place->second;
  };
}

Outcome outcome_of(const Opened& first, const Opened& second,
                   const compare::SceneDifference& found) {
  Outcome outcome;
  outcome.kind = word_of(first.kind);
  outcome.summary = summary_lines(first, second, found.compared_times);
  outcome.structure = found.structure;
  outcome.notes = found.notes;
  outcome.names = names_of(first.scene, second.scene);
  outcome.at_least = found.at_least;
  outcome.add_row("positions", Unit::length, found.positions);
  outcome.add_row("normals", Unit::angle, found.normals);
  outcome.add_tangents(found.tangents, found.tangent_sides);
  outcome.add_row("joint positions", Unit::length, found.joint_positions);
  outcome.add_row("joint orientations", Unit::angle, found.joint_orientations);
  outcome.add_row("morph targets", Unit::length, found.target_positions);
  outcome.add_row("morph targets' normals", Unit::ratio, found.target_normals);
  outcome.add_row("morph targets' tangents", Unit::ratio, found.target_tangents);
  outcome.add_row("texture coordinates", Unit::ratio, found.texture_coordinates);
  outcome.add_row("vertex colours", Unit::ratio, found.colours);
  outcome.add_row("weights", Unit::ratio, found.weights);
  // Key times are rounded to float; ignore such differences.
  if (found.times.largest > 1e-6) outcome.add_row("key times", Unit::time, found.times);
  outcome.add_parts(found.parts);
  outcome.add_joints(found.joints);
  outcome.same = found.same();
  return outcome;
}

}  // namespace

Result<Outcome> compare_scenes(const InputFile& first, InputKind first_kind,
                               const InputFile& second, InputKind second_kind,
                               const Options& options, ToolContext& context) {
  Opened a{first_kind, {}, {}};
  Opened b{second_kind, {}, {}};
  if (Status status = a.read(first, context); !status)
    return Error(status.error()).in_file(first.path());
  if (Status status = b.read(second, context); !status) {
    return Error(status.error()).in_file(second.path());
  }
  if (Status status = a.finish(b); !status) return Error(status.error()).in_file(first.path());
  if (Status status = b.finish(a); !status) return Error(status.error()).in_file(second.path());
  compare::SceneOptions how;
  how.tolerance = options.tolerance;
  how.matching = options.matching;
  how.materials = options.materials;
  how.images = pixel_distance();
  how.keep_vertices = !options.heatmap.empty();
  const auto found = compare::difference(a.scene, b.scene, how, context.jobs, *context.progress);
  if (!found) return found.error();
  const bool bare = a.scene.meshes.empty() || b.scene.meshes.empty();
  Outcome outcome = outcome_of(a, b, *found);
  const bool flat = first_kind == InputKind::points || second_kind == InputKind::points;
  const Status status = draw(
      options, context, found->same() || flat,
      [&] {
        return sheet_of(a.scene, b.scene, bare ? found->joint_positions : found->positions,
                        options.matching, options.materials);
      },
      outcome.pictures);
  if (!status) return status.error();
  const auto [first_name, second_name] = image_names(options);
  const PlottedScenes scenes{first_name, second_name, &a.scene, &*found};
  const Status drawn = plot(
      options, context, found->same(), [&] { return plot_of(scenes); }, outcome.chart);
  if (!drawn) return drawn.error();
  if (!options.heatmap.empty()) {
    const Status step = write_heatmap(a.scene, *found, options.heatmap, context);
    if (!step) return step.error();
  }
  return outcome;
}

}  // namespace krok::cli::diff
