#include "tools/krok-skin/small_rig.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "formats/gltf/quantize.h"
#include "formats/gltf/reduce_for_mesh.h"
#include "scene/influences.h"

namespace krok::cli::skin {

namespace {

std::string millimetres(double metres) {
  return readable(1e3 * metres, 3) + " mm";
}

// The palettes of the motion's frames, or of the reference pose.
PaletteSource palettes_of(const Subject& subject) {
  return [&subject, back = inverse_reference(subject.model.skeleton)](
             int frame, std::span<SkinMatrix> palette) {
    std::vector<Transform> pose(palette.size());
    subject.clip.get_pose(frame, pose);
    for (std::size_t j = 0; j < palette.size(); ++j) {
      const Stretch stretch =
          subject.stretches.empty()
              ? Stretch()
              : subject.stretches[static_cast<std::size_t>(frame) * palette.size() + j];
      palette[j] = skin_matrix(back[j], pose[j], stretch);
    }
  };
}

// Notes how joints that change scale are written, and warns where nodes cannot have it.
void report_stretch(const Subject& subject, const gltf::JointTracks& tracks, double largest_error,
                    ToolContext& context) {
  if (subject.stretches.empty()) return;
  const auto sheared = std::ranges::count_if(
      tracks.joints, [](const gltf::JointTrack& joint) { return !joint.inner_rotations.empty(); });
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
               fmt::format("joints below one that is flattened stand apart from it, which nodes "
                           "cannot have: they are up to {} off",
                           millimetres(largest_error)),
               "use --as clip to bake the mesh");
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
  const int frames = subject.clip.frame_count();
  MeshError error;
  if (changed > 0) {
    const PaletteSource palettes = palettes_of(subject);
    error = mesh_error({full, palettes}, {subject.model, palettes}, frames, context.jobs);
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

Result<SmallRig> small_rig(const Options& options, const Subject& subject, ToolContext& context) {
  if (options.compress && extension(context.output) == ".gltf") {
    return Error("usage", "--compress is for .glb files", "use -o OUT.glb").in_file(context.output);
  }
  double largest_error = 0;
  auto tracks =
      gltf::joint_tracks(subject.model.skeleton, subject.clip, subject.stretches, largest_error);
  if (!tracks) return tracks.error();
  report_stretch(subject, *tracks, largest_error, context);
  warn_of_second_set(subject.model, context);
  SmallRig rig{subject.model, subject.morphs, *std::move(tracks)};
  if (!options.reduce.empty() || options.quantize) {
    const gltf::JointTracks full = rig.tracks;
    Json facts;
    std::string words;
    if (!options.reduce.empty()) {
      const auto tolerance = reduce_tolerance(options);
      if (!tolerance) return tolerance.error();
      const auto reduction =
          gltf::reduce_for_mesh(rig.model, *tolerance, options.quantize, context.jobs, rig.tracks);
      if (!reduction) return reduction.error();
      facts["keys"] = reduction->keys_after;
      facts["keys_before"] = reduction->keys_before;
      words = fmt::format("{} of {}, ", grouped(static_cast<long long>(reduction->keys_after)),
                          counted(static_cast<long long>(reduction->keys_before), "key"));
      if (reduction->error.largest > *tolerance) {
        context.warn("skin-reduce",
                     fmt::format("rotations of 16 bits are up to {} off by themselves: all keys "
                                 "are kept",
                                 millimetres(reduction->error.largest)),
                     "use a larger tolerance, or leave out --quantize");
      }
    } else {
      gltf::round_rotations(rig.tracks);
    }
    const Model shown = options.quantize ? gltf::quantized(rig.model) : rig.model;
    const MeshError error = gltf::mesh_error(rig.model, full, shown, rig.tracks, context.jobs);
    facts.update(error_json(error));
    if (options.quantize) facts["quantization_bound"] = gltf::quantization_bound(rig.model);
    context.report.result["rig"] = std::move(facts);
    context.log(fmt::format("{}max error on the mesh {} (vertex {}, frame {})", words,
                            millimetres(error.largest), error.vertex,
                            readable(0.5 * error.moment)));
  }
  if (options.compress) gltf::order_for_compression(rig.model, rig.morphs);
  return rig;
}

}  // namespace krok::cli::skin
