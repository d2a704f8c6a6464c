#include "formats/gltf/joint_tracks.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "core/numbers.h"
#include "math/quaternion.h"

namespace krok::gltf {

namespace {

constexpr double kAngleTolerance = 1e-6;  // radians

// What a viewer makes of floats.
Transform as_viewed(const Vec3f& translation, const Quatf& rotation) {
  return {translation.cast<double>(), rotation.cast<double>().normalized()};
}

// The track of one joint. `parents` holds its parent's joint_to_world as viewed for each frame, or
// nothing for the root; `viewed` receives the joint's own.
void fill_track(const Clip& clip, int joint, const std::vector<Transform>& parents,
                double tolerance, JointTrack& track, std::vector<Transform>& viewed) {
  const int frames = clip.frame_count();
  const Quat rest = track.rest_rotation.cast<double>().normalized();
  track.rotations.resize(frames);
  track.translations.resize(frames);
  viewed.resize(frames);

  bool rotates = false, moves = false;
  Quat before = rest;
  for (int f = 0; f < frames; ++f) {
    const Transform parent = parents.empty() ? Transform() : parents[f];
    const Vec3 position = clip.frame_positions(f)[joint].cast<double>();
    const Quat orientation =
        normalized_or_identity(clip.frame_orientations(f)[joint].cast<double>());
    const Quat to_parent = parent.orientation.conjugate();
    const Quat local = in_hemisphere_of(before, normalized_or_identity(to_parent * orientation));
    before = local;
    track.rotations[f] = local.cast<float>();
    track.translations[f] = (to_parent * (position - parent.position)).cast<float>();
    rotates = rotates || angle_between(rest, local) > kAngleTolerance;
    const Vec3 kept = parent * track.rest_translation.cast<double>();
    moves = moves || (kept - position).norm() > tolerance;
  }
  if (!rotates) track.rotations.clear();
  if (!moves) track.translations.clear();
  for (int f = 0; f < frames; ++f) {
    const Transform local = as_viewed(moves ? track.translations[f] : track.rest_translation,
                                      rotates ? track.rotations[f] : track.rest_rotation);
    viewed[f] = parents.empty() ? local : parents[f] * local;
  }
}

}  // namespace

Result<std::vector<float>> key_times(int frames, double rate) {
  std::vector<float> times(frames);
  for (int f = 0; f < frames; ++f) {
    times[f] = static_cast<float>(f / rate);
    if (!std::isfinite(times[f]) || (f > 0 && !(times[f] > times[f - 1]))) {
      return Error("gltf-times",
                   fmt::format("at {} frames a second, frames {} and {} fall on the same time in "
                               "glTF, whose times are floats",
                               readable(rate), f - 1, f),
                   "cut the motion into shorter ones, or lower the rate");
    }
  }
  return times;
}

JointTracks rest_tracks(const Skeleton& rest) {
  JointTracks tracks;
  tracks.joints.resize(rest.names.size());
  for (int j = 0; j < rest.joint_count(); ++j) {
    const Transform local = rest.reference_local(j);
    tracks.joints[j].rest_translation = local.position.cast<float>();
    tracks.joints[j].rest_rotation = normalized_or_identity(local.orientation).cast<float>();
  }
  return tracks;
}

Result<JointTracks> joint_tracks(const Skeleton& rest, const Clip& clip, double tolerance) {
  assert(rest.joint_count() == clip.joint_count());
  auto times = key_times(clip.frame_count(), clip.rate);
  if (!times) return times.error();
  JointTracks tracks = rest_tracks(rest);
  tracks.times = std::move(*times);

  const auto children = rest.children();
  std::vector<std::vector<Transform>> viewed(rest.names.size());
  std::vector<std::size_t> waiting(rest.names.size());
  const std::vector<Transform> none;
  for (int j = 0; j < rest.joint_count(); ++j) {
    const int parent = rest.parents[j];
    waiting[j] = children[j].size();
    fill_track(clip, j, parent == Skeleton::kNoParent ? none : viewed[parent], tolerance,
               tracks.joints[j], viewed[j]);
    if (waiting[j] == 0) viewed[j] = {};
    // Memory for the frames of a parent whose children are all done is given back.
    if (parent != Skeleton::kNoParent && --waiting[parent] == 0) viewed[parent] = {};
  }
  return tracks;
}

}  // namespace krok::gltf
