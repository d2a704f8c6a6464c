#include "formats/gltf/reduce_for_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "core/index.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/filters_internal.h"
#include "skin/morph.h"

namespace krok::gltf {

namespace {

// Of the tolerance, what bits of one joint's keys may take; joints of a chain add up.
constexpr double kBitsShare = 0.15;
// What a loader computes from the file may be off by, beside rounded() and quantized().
constexpr double kDecodingShare = 0.002;
// Of the error that bits may make, from one attempt to the next.
constexpr double kCoarser = 1.5;
constexpr int kMinBits = 6, kMaxBits = 23;
// Of joints without vertices, for what viewers attach to them: metres.
constexpr double kMinReach = 0.05, kMinShell = 0.03;

// For each joint the largest share of a turn about it that a vertex takes: weight times distance.
// Joints without vertices still have to be in place, for what viewers attach to them.
std::vector<double> shells_of(const Model& model) {
  std::vector<double> shells(model.skeleton.names.size(), kMinShell);
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  for (std::size_t i = 0; i < model.influence_weights.size(); ++i) {
    const double weight = static_cast<double>(model.influence_weights[i]);
    if (!(weight > 0)) continue;
    const std::size_t joint = model.influence_joints[i];
    const Vec3 offset =
        model.positions[i / places].cast<double>() - model.skeleton.reference[joint].position;
    shells[joint] = std::max(shells[joint], weight * offset.norm());
  }
  return shells;
}

PaletteSource palettes_of(const Model& model, const JointTracks& tracks) {
  std::vector<Mat4> reference_to_joint;
  for (const Transform& to_joint : inverse_reference(model.skeleton)) {
    reference_to_joint.push_back(to_joint.matrix());
  }
  return [&model, &tracks, reference_to_joint = std::move(reference_to_joint)](
             int moment, std::span<SkinMatrix> palette) {
    std::vector<Mat4> joint_to_world(palette.size());
    TrackPoses(model.skeleton.parents, tracks).at(0.5 * moment, joint_to_world);
    for (std::size_t j = 0; j < palette.size(); ++j) {
      Eigen::Map<Mat4f>(palette[j].elements) =
          (joint_to_world[j] * reference_to_joint[j]).cast<float>();
    }
  };
}

// For each joint the largest distance of a vertex that moves with it, or with a joint below it.
std::vector<double> reaches_of(const Model& model) {
  std::vector<double> reaches(model.skeleton.names.size(), kMinReach);
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  for (std::size_t i = 0; i < model.influence_weights.size(); ++i) {
    const double weight = static_cast<double>(model.influence_weights[i]);
    if (!(weight > 0)) continue;
    const Vec3 position = model.positions[i / places].cast<double>();
    for (int joint = model.influence_joints[i]; joint >= 0;
         joint = model.skeleton.parents[at(joint)]) {
      const Vec3 offset = position - model.skeleton.reference[at(joint)].position;
      reaches[at(joint)] = std::max(reaches[at(joint)], weight * offset.norm());
    }
  }
  return reaches;
}

// Bits so that each joint's keys alone move vertices by about `error` metres at most.
void choose_bits(std::span<const double> reaches, double error, bool filtered,
                 JointTracks& tracks) {
  const int step = std::clamp(static_cast<int>(std::floor(std::log2(error))), -23, 0);
  for (std::size_t j = 0; j < tracks.joints.size(); ++j) {
    JointTrack& track = tracks.joints[j];
    // Half a step of 2^(1 - bits) in each of three components of a half angle.
    const double bits = 1 + std::log2(std::sqrt(3.0) * reaches[j] / error);
    const int needed = std::max(kMinBits, static_cast<int>(std::ceil(bits)));
    if (filtered) {
      track.rotation_bits = needed <= kMaxBits ? needed : JointTrack::kExact;
      track.translation_exponent = step;
    } else {
      track.rotation_bits =
          needed <= JointTrack::kShortBits ? JointTrack::kShortBits : JointTrack::kExact;
    }
  }
}

// Moment 2 f is frame f, 2 f + 1 half a frame later, as in MeshReduction.
ShapeAtMoment shape_of(const TrackedMesh& mesh) {
  if (mesh.weights == nullptr || mesh.weights->values.empty()) return {};
  return [mesh](int moment, std::span<Vec3f> positions) {
    std::vector<float> weights;
    weights_at(*mesh.weights, 0.5 * moment / mesh.weights->rate, weights);
    apply_morphs(*mesh.morphs, weights, {mesh.model.positions, {}}, {positions, {}});
  };
}

// The bytes of the keys of a file, with about what the JSON takes.
std::size_t size_of(const JointTracks& tracks, bool filtered) {
  constexpr std::size_t kAccessor = 100, kChannel = 85, kTranslation = 12, kRotation = 16;
  std::vector<std::uint32_t> translations, wide;
  std::vector<std::int16_t> rotations;
  std::set<std::vector<int>> times;
  std::size_t size = 0;
  const auto add = [&](const auto& values, std::size_t each, const std::vector<int>& frames,
                       const auto& stored, auto& all) {
    if (values.empty()) return;
    size += kAccessor + kChannel;
    if (filtered && stored) {
      all.insert(all.end(), stored->begin(), stored->end());
    } else {
      size += values.size() * each;
    }
    if (times.insert(frames).second) size += kAccessor + (filtered ? 3 : 4) * frames.size();
  };
  for (const JointTrack& track : tracks.joints) {
    const std::span<const Vec3f> moves = track.translations;
    const std::span<const Quatf> turns = track.rotations;
    const int bits = track.rotation_bits;
    std::optional<std::vector<std::uint32_t>> steps, wide_steps;
    std::optional<std::vector<std::int16_t>> shorts;
    if (filtered && track.translation_exponent != JointTrack::kExact && !moves.empty()) {
      steps = exponential({moves.data()->data(), 3 * moves.size()}, track.translation_exponent);
    }
    add(moves, kTranslation, track.translation_frames, steps, translations);
    if (bits <= JointTrack::kShortBits) {
      if (filtered) shorts = quaternion(turns, bits);
      add(turns, kRotation / 2, track.rotation_frames, shorts, rotations);
    } else {
      if (filtered && bits < JointTrack::kExact && !turns.empty()) {
        wide_steps = exponential({turns.data()->coeffs().data(), 4 * turns.size()}, 1 - bits);
      }
      add(turns, kRotation, track.rotation_frames, wide_steps, wide);
    }
  }
  return size + encode_attributes(std::as_bytes(std::span(translations)), kTranslation).size() +
         encode_attributes(std::as_bytes(std::span(wide)), kRotation).size() +
         encode_attributes(std::as_bytes(std::span(rotations)), kRotation / 2).size();
}

std::size_t key_count(const JointTracks& tracks) {
  std::size_t count = 0;
  for (const JointTrack& track : tracks.joints) {
    count += track.translations.size() + track.rotations.size();
  }
  return count;
}

Vec3f mean_of(std::span<const Vec3f> keys) {
  Vec3f sum = Vec3f::Zero();
  for (const Vec3f& key : keys) sum += key;
  return sum / static_cast<float>(keys.size());
}
Quatf mean_of(std::span<const Quatf> keys) {
  Eigen::Vector4f sum = Eigen::Vector4f::Zero();
  for (const Quatf& key : keys) sum += key.dot(keys[0]) < 0 ? -key.coeffs() : key.coeffs();
  return Quatf(sum).normalized();
}

// Of a joint, `away(a, b)` metres on the mesh.
template <typename Value, typename Away>
void choose_rest(std::span<JointTracks> clips, std::size_t joint, Value JointTrack::*rest,
                 std::vector<Value> JointTrack::*keys, double near, const Away& away) {
  Value best = clips.front().joints[joint].*rest;
  std::vector<Value> candidates = {best};
  for (JointTracks& clip : clips) {
    JointTrack& track = clip.joints[joint];
    if ((track.*keys).empty()) (track.*keys).assign(clip.times.size(), track.*rest);
    if (!(track.*keys).empty()) candidates.push_back(mean_of(std::span<const Value>(track.*keys)));
  }
  std::ptrdiff_t most = -1;
  for (const Value& value : candidates) {
    const auto count = std::ranges::count_if(clips, [&](const JointTracks& clip) {
      return std::ranges::all_of(clip.joints[joint].*keys,
                                 [&](const Value& key) { return away(value, key) < near; });
    });
    if (count > most) best = value;
    most = std::max(most, count);
  }
  for (JointTracks& clip : clips) clip.joints[joint].*rest = best;
}

}  // namespace

void choose_rest(const Model& model, double tolerance, std::span<JointTracks> clips) {
  constexpr double kNear = 0.3;  // of the tolerance
  if (clips.empty() || std::ranges::any_of(clips, &JointTracks::are_stretched)) return;
  const std::vector<double> reaches = reaches_of(model);
  for (std::size_t j = 0; j < clips.front().joints.size(); ++j) {
    choose_rest(clips, j, &JointTrack::rest_translation, &JointTrack::translations,
                kNear * tolerance,
                [](const Vec3f& a, const Vec3f& b) { return static_cast<double>((a - b).norm()); });
    choose_rest(clips, j, &JointTrack::rest_rotation, &JointTrack::rotations, kNear * tolerance,
                [&](const Quatf& a, const Quatf& b) {
                  return 2 * reaches[j] * static_cast<double>((a.conjugate() * b).vec().norm());
                });
  }
}

MeshError mesh_error(const TrackedMesh& a, const JointTracks& a_tracks, const TrackedMesh& b,
                     const JointTracks& b_tracks, int jobs) {
  return mesh_error(a, a_tracks, shown({b.model, palettes_of(b.model, b_tracks), shape_of(b)}),
                    jobs);
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): a std::function frees what it holds

MeshError mesh_error(const TrackedMesh& a, const JointTracks& a_tracks, const ShownMesh& b,
                     int jobs) {
  std::size_t frames = a_tracks.times.size();
  if (frames == 0 && a.weights != nullptr) frames = at(a.weights->frame_count());
  return krok::mesh_error(shown({a.model, palettes_of(a.model, a_tracks), shape_of(a)}), b,
                          a.model.vertex_count(), std::max(1, 2 * static_cast<int>(frames) - 1),
                          jobs);
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): the same

Result<MeshReduction> reduce_for_mesh(const TrackedMesh& model, const TrackedMesh& kept,
                                      const MeshReduceOptions& options, int jobs,
                                      JointTracks& tracks) {
  const JointTracks full = tracks;
  const std::vector<double> shells = shells_of(model.model), reaches = reaches_of(model.model);
  MeshReduction best;
  std::size_t best_size = std::numeric_limits<std::size_t>::max();
  // Compressed, a key takes about 3.6 bytes, its time 2.8 and the JSON of separate times 105.
  const auto frames = static_cast<double>(std::max<std::size_t>(full.times.size(), 1));
  const double most_kept = options.filtered ? std::max(0.56 - 16.4 / frames, 2.0 / frames) : 1.0;
  // Keys within `factor` of the tolerance, with bits within `bits_error` metres and then, with
  // `coarser`, fewer as long as that fits.
  const auto attempt = [&](double factor, double bits_error, bool coarser,
                           double kept_share) -> Result<bool> {
    JointTracks fewer = full;
    auto reduction = reduce_tracks(model.model.skeleton,
                                   {.tolerance = factor * options.tolerance,
                                    .shell_distances = shells,
                                    .most_kept = kept_share},
                                   jobs, fewer);
    if (!reduction) return std::move(reduction).error();
    for (bool fits_any = false;; fits_any = true, bits_error *= kCoarser) {
      if (options.short_keys) choose_bits(reaches, bits_error, options.filtered, fewer);
      const MeshError error = mesh_error(model, full, kept, rounded(fewer, options.filtered), jobs);
      if (error.largest > (1 - kDecodingShare) * options.tolerance) return fits_any;
      if (const std::size_t size = size_of(fewer, options.filtered); size < best_size) {
        best = {error, reduction->keys_before, reduction->keys_after};
        best_size = size;
        tracks = fewer;
      }
      if (!coarser || bits_error > options.tolerance) return true;
    }
  };
  // Between what always fits and what never does, by halves of the logarithm.
  double low = 1.0 / 64, high = 4;
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    const double middle = round == 0 ? 1.0 : std::sqrt(low * high);
    const auto fits = attempt(middle, kBitsShare * middle * options.tolerance, false, most_kept);
    if (!fits) return fits.error();
    (*fits ? low : high) = middle;
  }
  // What keys leave of the tolerance, and more of it, for fewer bits; all of it with all keys.
  for (const double share : {1.0, 0.5, 0.125, 0.0}) {
    if (!options.short_keys || !options.filtered) break;
    const auto fits =
        attempt(std::max(share * low, 0.1), 2 * kBitsShare * std::min(1.0, low) * options.tolerance,
                true, share > 0 ? most_kept : 0.0);
    if (!fits) return fits.error();
  }
  if (best_size < std::numeric_limits<std::size_t>::max()) return best;
  tracks = full;
  return MeshReduction{mesh_error(model, full, kept, tracks, jobs), key_count(full),
                       key_count(full)};
}

}  // namespace krok::gltf
