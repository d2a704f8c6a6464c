#include "tools/krok-skin/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numbers.h"
#include "formats/gltf/quantize.h"
#include "formats/gltf/reduce_for_mesh.h"
#include "scene/model.h"

namespace krok::cli::skin {

namespace {

// Of the tolerance of --reduce, what positions, and weights, of vertices may take alone, and both.
constexpr double kMinVertexShare = 0.15, kMaxVertexShare = 0.7, kMaxShareOfBoth = 0.8;
// And the keys of morph weights.
constexpr double kMaxWeightShare = 0.3;

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
    context.diagnose(make_diagnostic(
        Severity::note, "skin-stretch",
        fmt::format("{} of {} shear, which no node does: each got a node above it", sheared,
                    counted(subject.model.skeleton.joint_count(), "joint"))));
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
  for (std::size_t i = 0; i < names.size(); ++i) all.push_back({names[i], &tracks[i], weights[i]});
  return all;
}

Result<Clips> clips_of(const Subject& subject, const std::string& still_name,
                       ToolContext& context) {
  Clips clips;
  double largest_error = 0;
  for (const Subject::NamedMotion& motion : subject.all_motions(still_name)) {
    double error = 0;
    const Skeleton& skeleton = subject.model.skeleton;
    auto tracks = motion.frames != nullptr
                      ? gltf::streamed_tracks(skeleton, *motion.frames, context.jobs)
                      : gltf::joint_tracks(skeleton, motion.clip, motion.stretches, error);
    if (!tracks) return tracks.error();
    tracks->removed_root_motion = motion.clip.provenance.removed_root_motion;
    largest_error = std::max(largest_error, error);
    clips.names.push_back(motion.name);
    clips.tracks.push_back(*std::move(tracks));
    clips.weights.push_back(motion.weights.values.empty() ? nullptr : &motion.weights);
  }
  report_stretch(subject, clips.tracks, largest_error, context);
  return clips;
}

namespace {

// What --reduce does to all clips.
struct Reduction {
  std::size_t keys = 0, keys_before = 0;
};

// What is left of a rig, as a viewer decodes it.
struct Shown {
  Model model;
  MorphSet morphs;
};

gltf::TrackedMesh mesh_of(const Model& model, const MorphSet& morphs, const MorphWeights* weights) {
  if (weights == nullptr) return {model};
  return {model, &morphs, weights};
}

class BitsLost {
 public:
  BitsLost(const SmallRig& rig, int jobs)
      : rig_(rig), full_(rig.clips.tracks), few_weights_(rig.clips.weights), jobs_(jobs) {}

  // Morph weights of fewer keys and bits from here on: as few as leave vertices within a share of
  // the tolerance, or with a tolerance of 0 all keys.
  std::deque<MorphWeights> reduce_weights(double tolerance, bool quantize) {
    std::deque<MorphWeights> few;
    const std::vector<double> reaches = target_reaches();
    for (std::size_t i = 0; i < full_.size(); ++i) {
      const MorphWeights* const weights = rig_.clips.weights[i];
      if (weights == nullptr || reaches.empty()) continue;
      MorphWeights& made = few.emplace_back();
      few_weights_[i] = &made;
      const auto fits = [&](double slack, int bits) {
        std::vector<float> slacks;
        for (const double reach : reaches) {
          slacks.push_back(static_cast<float>(std::min(1.0, slack / reach)));
        }
        made = gltf::on_keys(*weights, slacks, bits);
        return slack == 0 || gltf::mesh_error(original(i), full_[i],
                                              left({rig_.model, rig_.morphs}, i), full_[i], jobs_)
                                     .largest < kMaxWeightShare * tolerance;
      };
      bool done = false;
      for (double slack = tolerance; !done && slack > 0.02 * tolerance; slack *= 0.5) {
        done = (quantize && fits(slack, 8)) || fits(slack, quantize ? 16 : 32);
      }
      if (!done) fits(0, quantize ? 16 : 32);
    }
    return few;
  }

  Shown shown(const std::optional<gltf::Quantization>& quantization) const {
    if (!quantization) return {rig_.model, rig_.morphs};
    Model model = gltf::quantized(rig_.model, *quantization);
    MorphSet morphs = gltf::quantized(rig_.morphs, rig_.model, model, *quantization);
    return {std::move(model), std::move(morphs)};
  }

  Result<Reduction> reduce(const Shown& shown, const gltf::MeshReduceOptions& options,
                           std::vector<gltf::JointTracks>& clips) const {
    Reduction all;
    for (std::size_t i = 0; i < clips.size(); ++i) {
      const auto one = gltf::reduce_for_mesh(original(i), left(shown, i), options, jobs_, clips[i]);
      if (!one) return one.error();
      all.keys += one->keys_after;
      all.keys_before += one->keys_before;
    }
    return all;
  }

  // The largest error on the mesh of all clips, and the clip's index.
  std::pair<MeshError, std::size_t> largest(const Shown& shown,
                                            const std::vector<gltf::JointTracks>& clips) const {
    std::pair<MeshError, std::size_t> worst;
    for (std::size_t i = 0; i < clips.size(); ++i) {
      const MeshError error =
          gltf::mesh_error(original(i), full_[i], left(shown, i), clips[i], jobs_);
      if (i == 0 || error.largest > worst.first.largest) worst = {error, i};
    }
    return worst;
  }

  // How exactly vertices are stored, with a tolerance for them and their keys; 0 without one.
  gltf::Quantization quantization_for(double tolerance, bool filtered) const {
    gltf::Quantization result{.filtered = filtered};
    if (filtered) result.coordinate_bits = 14;
    if (tolerance == 0) return result;
    // A bit less of all vertices, or of all keys, takes a number of bytes in proportion to theirs.
    // About half of the keys are left.
    const auto vertices = static_cast<double>(rig_.model.vertex_count());
    double keys = 0;
    for (const gltf::JointTracks& tracks : full_) {
      for (const gltf::JointTrack& track : tracks.joints) {
        keys += 0.5 * static_cast<double>(track.translations.size() + track.rotations.size());
      }
    }
    double share =
        std::clamp(vertices / std::max(1.0, vertices + keys), kMinVertexShare, kMaxVertexShare);
    for (;; share *= 0.8) {
      // A vertex, and each of its targets, is off by half a step along each axis.
      result.position_step = share * tolerance * 2 / std::sqrt(3.0) / shapes_at_once();
      result.weight_bits = weight_bits_within(share * tolerance, filtered);
      if (share <= kMinVertexShare ||
          largest(shown(result), full_).first.largest < kMaxShareOfBoth * tolerance) {
        return result;
      }
    }
  }

 private:
  gltf::TrackedMesh original(std::size_t clip) const {
    return mesh_of(rig_.model, rig_.morphs, rig_.clips.weights[clip]);
  }
  gltf::TrackedMesh left(const Shown& shown, std::size_t clip) const {
    return mesh_of(shown.model, shown.morphs, few_weights_[clip]);
  }

  // How far each target moves a vertex, metres.
  std::vector<double> target_reaches() const {
    std::vector<double> reaches;
    for (int t = 0; t < rig_.morphs.target_count(); ++t) {
      const auto moved = rig_.morphs.target_positions(t);
      double reach = 1e-6;
      for (std::size_t v = 0; v < moved.size(); ++v) {
        const Vec3f way = moved[v] - rig_.model.positions[v];
        reach = std::max(reach, static_cast<double>(way.norm()));
      }
      reaches.push_back(reach);
    }
    return reaches;
  }

  // How many shapes' errors add up in a vertex: sum |w| of the targets, |1 - sum w| of the mesh.
  double shapes_at_once() const {
    double most = 1;
    for (const MorphWeights* weights : rig_.clips.weights) {
      const std::size_t targets = weights == nullptr ? 0 : weights->names.size();
      for (std::size_t i = 0; targets > 0 && i + targets <= weights->values.size(); i += targets) {
        double sum = 0, size = 0;
        for (const float weight : std::span(weights->values).subspan(i, targets)) {
          sum += static_cast<double>(weight);
          size += std::abs(static_cast<double>(weight));
        }
        most = std::max(most, size + std::abs(1 - sum));
      }
    }
    return most;
  }

  // The bits of weights whose error alone is less than `limit`, for vertices of the finest step.
  int weight_bits_within(double limit, bool filtered) const {
    gltf::Quantization trial{.filtered = filtered};
    const auto fits = [&](int bits) {
      trial.weight_bits = bits;
      return largest(shown(trial), full_).first.largest < limit;
    };
    if (fits(8)) return 8;
    if (!filtered) return 16;
    int low = 8, high = 16;  // the first does not fit
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (fits(middle) ? high : low) = middle;
    }
    return high;
  }

  const SmallRig& rig_;
  const std::vector<gltf::JointTracks> full_;
  std::vector<const MorphWeights*> few_weights_;  // [clips] or null
  int jobs_;
};

// Applies --reduce and --quantize.
Status lose_bits(const Options& options, SmallRig& rig, int jobs) {
  BitsLost lost(rig, jobs);
  const double tolerance = options.reduce.value_or(0);
  rig.few_weights = lost.reduce_weights(tolerance, options.quantize);
  const bool filtered = options.compress && options.quantize;
  if (options.quantize) rig.quantization = lost.quantization_for(tolerance, filtered);
  rig.facts = Json::object();
  rig.all_keys = rig.clips.tracks;
  if (tolerance > 0) {
    const auto reduction =
        lost.reduce(lost.shown(rig.quantization),
                    {.tolerance = tolerance, .short_keys = options.quantize, .filtered = filtered},
                    rig.clips.tracks);
    if (!reduction) return reduction.error();
    rig.facts["keys"] = reduction->keys;
    rig.facts["keys_before"] = reduction->keys_before;
  } else {
    for (gltf::JointTracks& tracks : rig.clips.tracks) {
      for (gltf::JointTrack& track : tracks.joints) track.rotation_bits = 16;
    }
  }
  auto few = rig.few_weights.begin();
  rig.all_weights = rig.clips.weights;
  for (const MorphWeights*& weights : rig.clips.weights) {
    if (weights != nullptr && few != rig.few_weights.end()) weights = &*few++;
  }
  return {};
}

// Sets of texture coordinates after the last that a texture of a part uses; of the first one, which
// other programs may want to put textures on, only with --minify.
void drop_unused_sets(bool minify, std::span<const Material> materials, Model& model,
                      ToolContext& context) {
  std::size_t used = minify ? 0 : 1;
  for (const Model::Part& part : model.parts) {
    const Material* const material = find_material(materials, part.material);
    if (material == nullptr) continue;
    for (const Texture* texture : all_textures_of(*material)) {
      if (*texture) used = std::max(used, static_cast<std::size_t>(texture->set) + 1);
    }
  }
  const std::size_t first = model.texture_coordinates.empty() ? 0 : 1;
  const std::size_t sets = first + model.more_texture_coordinates.size();
  if (sets <= used) return;
  context.log(fmt::format(
      "{} that no texture uses left out",
      counted(sets - used, "set of texture coordinates", "sets of texture coordinates")));
  model.more_texture_coordinates.resize(used > first ? used - first : 0);
  if (used == 0) model.texture_coordinates.clear();
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
  if (options.quantize || options.compress || options.minify) {
    drop_unused_sets(options.minify, subject.materials, rig.model, context);
  }
  if (options.minify && options.reduce) {
    gltf::choose_rest(rig.model, *options.reduce, rig.clips.tracks);
  }
  if (options.reduce || options.quantize) {
    if (Status status = lose_bits(options, rig, context.jobs); !status) return status.error();
  }
  if (options.compress) {
    rig.places = gltf::order_for_compression(rig.model, rig.morphs, rig.quantization);
  }
  return rig;
}

Result<bool> report_loss(const std::string& path, const Options& options, const Subject& subject,
                         SmallRig& rig, ToolContext& context) {
  std::vector<gltf::NamedTracks> all_keys = rig.clips.named();
  for (std::size_t i = 0; i < all_keys.size(); ++i) {
    all_keys[i].tracks = &rig.all_keys[i];
    all_keys[i].weights = rig.all_weights[i];
  }
  const auto found = gltf::written_error(path, {subject.model, subject.morphs, all_keys},
                                         {rig.model, rig.places}, context.jobs);
  if (!found) return found.error();
  const MeshError& error = found->error;
  Json& facts = rig.facts;
  std::string words, where;
  if (facts.contains("keys")) {
    words = fmt::format("{} of {}, ", grouped(facts["keys"].get<long long>()),
                        counted(facts["keys_before"].get<long long>(), "key"));
  }
  facts["largest_error"] = error.largest;
  facts["vertex"] = error.vertex;
  facts["frame"] = 0.5 * error.moment;
  if (all_keys.size() > 1) {
    facts["clip"] = all_keys[found->clip].name;
    where = all_keys[found->clip].name + ", ";
  }
  if (rig.quantization) {
    facts["quantization_bound"] = gltf::quantization_bound(subject.model, *rig.quantization);
    facts["weight_bits"] = rig.quantization->weight_bits;
    facts["normal_error"] = gltf::normal_error(subject.model, *rig.quantization);
  }
  const double tolerance = options.reduce.value_or(0);
  const bool misses = tolerance > 0 && error.largest > tolerance;
  if (tolerance > 0) facts["within_tolerance"] = !misses;
  context.report.result["rig"] = std::move(facts);
  context.log(fmt::format("{}max error on the mesh {} (vertex {}, {}frame {})", words,
                          millimetres(error.largest), error.vertex, where,
                          readable(0.5 * error.moment)));
  if (misses) {
    context.warn(
        "skin-tolerance",
        fmt::format("--reduce {} asks for less error than the {} that remain with all keys",
                    millimetres(tolerance), millimetres(error.largest)),
        rig.quantization ? "leave out --quantize, which has 65535 steps for the mesh's "
                           "longest side, or allow more"
                         : "allow more: floats are not more exact");
  }
  return !misses;
}

}  // namespace krok::cli::skin
