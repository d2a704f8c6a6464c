#include "formats/gltf/reduce_for_mesh.h"

#include <algorithm>
#include <cmath>

#include "formats/gltf/reduce_tracks.h"
#include "formats/gltf/track_poses.h"
#include "math/quaternion.h"

namespace krok::gltf {

namespace {

// For each joint the largest share of a turn about it that a vertex takes: weight times distance.
// Joints without vertices still have to be in place, for what viewers attach to them.
std::vector<double> shells_of(const Model& model) {
  std::vector<double> shells(model.skeleton.names.size(), 0);
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

float rounded_to_short(float value) {
  return std::round(std::clamp(value, -1.0f, 1.0f) * 32767.0f) / 32767.0f;
}

}  // namespace

MeshError mesh_error(const Model& a, const JointTracks& a_tracks, const Model& b,
                     const JointTracks& b_tracks, int jobs) {
  const int frames = static_cast<int>(a_tracks.times.size());
  return krok::mesh_error({a, palettes_of(a, a_tracks)}, {b, palettes_of(b, b_tracks)},
                          std::max(1, 2 * frames - 1), jobs);
}

void round_rotations(JointTracks& tracks) {
  for (JointTrack& track : tracks.joints) {
    for (std::vector<Quatf>* rotations : {&track.rotations, &track.inner_rotations}) {
      for (Quatf& rotation : *rotations) {
        rotation.normalize();
        for (float& component : rotation.coeffs()) component = rounded_to_short(component);
      }
    }
  }
}

Result<MeshReduction> reduce_for_mesh(const Model& model, double tolerance, bool short_rotations,
                                      int jobs, JointTracks& tracks) {
  const JointTracks full = tracks;
  const std::vector<double> shells = shells_of(model);
  MeshReduction best;
  bool found = false;
  const auto attempt = [&](double factor) -> Result<bool> {
    JointTracks fewer = full;
    const ReduceOptions options{.tolerance = factor * tolerance, .shell_distances = shells};
    auto reduction = reduce_tracks(model.skeleton, options, jobs, fewer);
    if (!reduction) return std::move(reduction).error();
    if (short_rotations) round_rotations(fewer);
    const MeshError error = mesh_error(model, full, model, fewer, jobs);
    const bool fits = error.largest <= tolerance;
    if (fits && (!found || reduction->keys_after < best.keys_after)) {
      best = {error, reduction->keys_before, reduction->keys_after};
      tracks = std::move(fewer);
      found = true;
    }
    return fits;
  };
  // Between what always fits and what never does, by halves of the logarithm.
  double low = 1.0 / 64, high = 4;
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    const double middle = round == 0 ? 1.0 : std::sqrt(low * high);
    const auto fits = attempt(middle);
    if (!fits) return fits.error();
    (*fits ? low : high) = middle;
  }
  if (found) return best;
  const std::size_t keys = [&] {
    std::size_t count = 0;
    for (const JointTrack& track : full.joints) {
      count += track.translations.size() + track.rotations.size();
    }
    return count;
  }();
  tracks = full;
  if (short_rotations) round_rotations(tracks);
  return MeshReduction{mesh_error(model, full, model, tracks, jobs), keys, keys};
}

}  // namespace krok::gltf
