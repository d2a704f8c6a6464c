#include "tools/krok-skin/small_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/numbers.h"
#include "formats/gltf/quantize.h"
#include "formats/gltf/reduce_for_mesh.h"
#include "scene/influences.h"

namespace krok::cli::skin {

namespace {

std::string millimetres(double metres) {
  return readable(1e3 * metres, 3) + " mm";
}

// The palettes of a motion's frames.
PaletteSource palettes_of(const Skeleton& skeleton, const Clip& clip, const Stretches& stretches) {
  return [&clip, &stretches, back = inverse_reference(skeleton)](int frame,
                                                                 std::span<SkinMatrix> palette) {
    std::vector<Transform> pose(palette.size());
    clip.get_pose(frame, pose);
    for (std::size_t j = 0; j < palette.size(); ++j) {
      const Stretch stretch = stretches.empty()
                                  ? Stretch()
                                  : stretches[static_cast<std::size_t>(frame) * palette.size() + j];
      palette[j] = skin_matrix(back[j], pose[j], stretch);
    }
  };
}

// Notes how joints that change scale are written, and warns where nodes cannot have it.
void report_stretch(const Subject& subject, const std::vector<gltf::JointTracks>& all,
                    double largest_error, ToolContext& context) {
  if (std::ranges::none_of(all, &gltf::JointTracks::are_stretched)) return;
  int sheared = 0;
  for (int j = 0; j < subject.model.skeleton.joint_count(); ++j) {
    sheared += std::ranges::any_of(all, [&](const gltf::JointTracks& tracks) {
      return !tracks.joints[static_cast<std::size_t>(j)].inner_rotations.empty();
    });
  }
  context.report.result["joints_with_stretch_nodes"] = sheared;
  if (sheared > 0) {
    Diagnostic note =
        make_warning("skin-stretch",
                     fmt::format("{} of {} shear, which no node does: each got a node above it",
                                 sheared, counted(subject.model.skeleton.joint_count(), "joint")));
    note.severity = Severity::note;
    context.diagnose(std::move(note));
  }
  if (largest_error < 2e-4) return;
  context.warn("skin-stretch",
               fmt::format("joints below one that is flattened are apart from it, which nodes "
                           "cannot have: they are up to {} off",
                           millimetres(largest_error)),
               "use --as baked to bake the mesh");
}

void warn_of_second_set(const Model& model, ToolContext& context) {
  if (used_influences(model) <= 4) return;
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  long long many = 0;
  for (std::size_t i = 4; i < model.influence_weights.size(); i += places) {
    if (model.influence_weights[i] > 0) ++many;
  }
  context.warn("skin-influences",
               fmt::format("{} more than 4 influences: the file has a second set of them "
                           "(JOINTS_1), which three.js and other viewers do not read",
                           many == 1 ? "1 vertex has" : grouped(many) + " vertices have"),
               "use --influences 4 to keep the largest; what that moves is measured");
}

}  // namespace

void apply_influence_limit(const Options& options, Subject& subject, ToolContext& context) {
  if (options.influences == Influences::all) return;
  const Model full = subject.model;
  const int limit = static_cast<int>(options.influences);
  const int changed = limit_influences(subject.model, limit);
  MeshError error;
  const auto measure = [&](const Clip& clip, const Stretches& stretches) {
    const PaletteSource palettes = palettes_of(full.skeleton, clip, stretches);
    const MeshError of_clip =
        mesh_error({full, palettes}, {subject.model, palettes}, clip.frame_count(), context.jobs);
    if (of_clip.largest > error.largest) error = of_clip;
  };
  if (changed > 0) {
    measure(subject.clip, subject.stretches);
    for (const Subject::Motion& other : subject.others) measure(other.clip, other.stretches);
  }
  context.report.result["influences"] = {{"limit", limit},
                                         {"vertices_changed", changed},
                                         {"largest_error", error.largest},
                                         {"vertex", error.vertex},
                                         {"frame", error.moment}};
  if (changed == 0) return;
  context.log(
      fmt::format("--influences {}: {} of {} had more; off by up to {} (vertex {}, frame "
                  "{})",
                  limit, grouped(changed), counted(full.vertex_count(), "vertex", "vertices"),
                  millimetres(error.largest), error.vertex, error.moment));
}

std::vector<gltf::NamedTracks> Clips::named() const {
  std::vector<gltf::NamedTracks> all;
  for (std::size_t i = 0; i < names.size(); ++i) all.push_back({names[i], &tracks[i]});
  return all;
}

Result<Clips> clips_of(const Subject& subject, const std::string& still_name,
                       ToolContext& context) {
  Clips clips;
  double largest_error = 0;
  for (const Subject::NamedMotion& motion : subject.all_motions(still_name)) {
    double error = 0;
    auto tracks = gltf::joint_tracks(subject.model.skeleton, motion.clip, motion.stretches, error);
    if (!tracks) return tracks.error();
    largest_error = std::max(largest_error, error);
    clips.names.push_back(motion.name);
    clips.tracks.push_back(*std::move(tracks));
  }
  report_stretch(subject, clips.tracks, largest_error, context);
  return clips;
}

namespace {

// What --reduce does to all clips.
struct Reduction {
  std::size_t keys = 0, keys_before = 0;
  double largest = 0;  // error, metres
};

Result<Reduction> reduce(const Model& model, double tolerance, bool short_rotations, int jobs,
                         std::vector<gltf::JointTracks>& clips) {
  Reduction all;
  for (gltf::JointTracks& tracks : clips) {
    const auto one = gltf::reduce_for_mesh(model, tolerance, short_rotations, jobs, tracks);
    if (!one) return one.error();
    all.keys += one->keys_after;
    all.keys_before += one->keys_before;
    all.largest = std::max(all.largest, one->error.largest);
  }
  return all;
}

// Fewer keys, and rotations of 16 bits if the tolerance allows them in all clips.
Result<Reduction> reduce(double tolerance, int jobs, SmallRig& rig) {
  const std::vector<gltf::JointTracks> full = rig.clips.tracks;
  auto reduction = reduce(rig.model, tolerance, rig.short_rotations, jobs, rig.clips.tracks);
  if (!reduction || !rig.short_rotations || reduction->largest <= tolerance) return reduction;
  rig.short_rotations = false;
  rig.clips.tracks = full;
  return reduce(rig.model, tolerance, false, jobs, rig.clips.tracks);
}

// The largest error on the mesh of all clips, and the clip's index.
std::pair<MeshError, std::size_t> largest_error(const Model& model,
                                                const std::vector<gltf::JointTracks>& full,
                                                const Model& shown,
                                                const std::vector<gltf::JointTracks>& clips,
                                                int jobs) {
  std::pair<MeshError, std::size_t> largest;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const MeshError error = gltf::mesh_error(model, full[i], shown, clips[i], jobs);
    if (i == 0 || error.largest > largest.first.largest) largest = {error, i};
  }
  return largest;
}

// Applies --reduce and --quantize, and reports the error of both.
Status lose_bits(const Options& options, SmallRig& rig, ToolContext& context) {
  const std::vector<gltf::JointTracks> full = rig.clips.tracks;
  const Model shown = options.quantize ? gltf::quantized(rig.model) : rig.model;
  Json facts;
  std::string words;
  rig.short_rotations = options.quantize;
  if (!options.reduce.empty()) {
    const auto tolerance = reduce_tolerance(options);
    if (!tolerance) return tolerance.error();
    // What vertices lose already is not left for keys.
    const double lost = largest_error(rig.model, full, shown, full, context.jobs).first.largest;
    const auto reduction =
        reduce(std::max(*tolerance - lost, 0.25 * *tolerance), context.jobs, rig);
    if (!reduction) return reduction.error();
    facts["keys"] = reduction->keys;
    facts["keys_before"] = reduction->keys_before;
    words = fmt::format("{} of {}, ", grouped(static_cast<long long>(reduction->keys)),
                        counted(static_cast<long long>(reduction->keys_before), "key"));
  } else {
    for (gltf::JointTracks& tracks : rig.clips.tracks) gltf::round_rotations(tracks);
  }
  const auto [error, clip] = largest_error(rig.model, full, shown, rig.clips.tracks, context.jobs);
  facts["largest_error"] = error.largest;
  facts["vertex"] = error.vertex;
  facts["frame"] = 0.5 * error.moment;
  std::string where;
  if (full.size() > 1) {
    facts["clip"] = rig.clips.names[clip];
    where = rig.clips.names[clip] + ", ";
  }
  facts["rotation_bits"] = rig.short_rotations ? 16 : 32;
  if (options.quantize) facts["quantization_bound"] = gltf::quantization_bound(rig.model);
  context.report.result["rig"] = std::move(facts);
  context.log(fmt::format("{}max error on the mesh {} (vertex {}, {}frame {})", words,
                          millimetres(error.largest), error.vertex, where,
                          readable(0.5 * error.moment)));
  return {};
}

}  // namespace

Result<SmallRig> small_rig(const Options& options, const Subject& subject,
                           const std::string& still_name, ToolContext& context) {
  if (options.compress && extension(context.output) == ".gltf") {
    return Error("usage", "--compress is for .glb files", "use -o OUT.glb").in_file(context.output);
  }
  auto clips = clips_of(subject, still_name, context);
  if (!clips) return clips.error();
  warn_of_second_set(subject.model, context);
  SmallRig rig{subject.model, subject.morphs, *std::move(clips)};
  if (!options.reduce.empty() || options.quantize) {
    if (Status status = lose_bits(options, rig, context); !status) return status.error();
  }
  if (options.compress) gltf::order_for_compression(rig.model, rig.morphs);
  return rig;
}

}  // namespace krok::cli::skin
