#include "tools/krok-skin/small_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

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

Json error_json(const MeshError& error) {
  return {
      {"largest_error", error.largest}, {"vertex", error.vertex}, {"frame", 0.5 * error.moment}};
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

// What --reduce and --quantize did to all clips.
struct Loss {
  std::size_t keys = 0, keys_before = 0;
  MeshError error;     // the largest of all clips
  std::string clip;    // in which that is
  double rounded = 0;  // the largest error of reduced clips, metres
};

Result<Loss> make_small(const Options& options, std::optional<double> tolerance, SmallRig& rig,
                        ToolContext& context) {
  Loss loss;
  const Model shown = options.quantize ? gltf::quantized(rig.model) : rig.model;
  for (std::size_t i = 0; i < rig.clips.names.size(); ++i) {
    gltf::JointTracks& tracks = rig.clips.tracks[i];
    const gltf::JointTracks full = tracks;
    if (tolerance) {
      const auto reduction =
          gltf::reduce_for_mesh(rig.model, *tolerance, options.quantize, context.jobs, tracks);
      if (!reduction) return reduction.error();
      loss.keys += reduction->keys_after;
      loss.keys_before += reduction->keys_before;
      loss.rounded = std::max(loss.rounded, reduction->error.largest);
    } else {
      gltf::round_rotations(tracks);
    }
    const MeshError error = gltf::mesh_error(rig.model, full, shown, tracks, context.jobs);
    if (i > 0 && error.largest <= loss.error.largest) continue;
    loss.error = error;
    loss.clip = rig.clips.names[i];
  }
  return loss;
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
    std::optional<double> tolerance;
    if (!options.reduce.empty()) {
      const auto given = reduce_tolerance(options);
      if (!given) return given.error();
      tolerance = *given;
    }
    const auto loss = make_small(options, tolerance, rig, context);
    if (!loss) return loss.error();
    Json facts;
    std::string words;
    if (tolerance) {
      facts["keys"] = loss->keys;
      facts["keys_before"] = loss->keys_before;
      words = fmt::format("{} of {}, ", grouped(static_cast<long long>(loss->keys)),
                          counted(static_cast<long long>(loss->keys_before), "key"));
      if (loss->rounded > *tolerance) {
        context.warn("skin-reduce",
                     fmt::format("rotations of 16 bits are up to {} off by themselves: all keys "
                                 "are kept",
                                 millimetres(loss->rounded)),
                     "use a larger tolerance, or leave out --quantize");
      }
    }
    facts.update(error_json(loss->error));
    if (rig.clips.names.size() > 1) facts["clip"] = loss->clip;
    if (options.quantize) facts["quantization_bound"] = gltf::quantization_bound(rig.model);
    context.report.result["rig"] = std::move(facts);
    context.log(fmt::format("{}max error on the mesh {} (vertex {}, {}frame {})", words,
                            millimetres(loss->error.largest), loss->error.vertex,
                            rig.clips.names.size() > 1 ? loss->clip + ", " : "",
                            readable(0.5 * loss->error.moment)));
  }
  if (options.compress) gltf::order_for_compression(rig.model, rig.morphs);
  return rig;
}

}  // namespace krok::cli::skin
