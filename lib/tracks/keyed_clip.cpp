#include "tracks/keyed_clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"
#include "scene/frame_moment.h"
#include "tracks/sample_keys.h"

namespace krok {

namespace {

bool uses_velocities(const VectorTrack& track) {
  return track.curve == VectorCurve::hermite || track.curve == VectorCurve::monotone;
}
bool uses_velocities(const RotationTrack& track) {
  return track.curve == RotationCurve::squad;
}

bool is_sound(const Vec3& value) {
  return value.allFinite();
}
bool is_sound(const Quat& value) {
  return value.coeffs().allFinite() && std::abs(value.norm() - 1) <= 1e-3;
}

Error in_joint(Error error, const std::string& joint) {
  error.joint = joint;
  return error;
}

template <typename Track>
Status check_track(const Track& track, const char* what, const std::string& joint,
                   double duration) {
  const std::size_t keys = track.times.size();
  if (track.values.size() != keys ||
      track.velocities.size() != (uses_velocities(track) ? keys : 0)) {
    return in_joint(
        Error("keyed-shape",
              fmt::format("the {} of joint {} has {} times, {} values and {} velocities", what,
                          joint, keys, track.values.size(), track.velocities.size())),
        joint);
  }
  for (std::size_t k = 0; k < keys; ++k) {
    const double time = track.times[k];
    if (!(time >= 0 && time <= duration) || (k > 0 && !(time > track.times[k - 1]))) {
      return in_joint(
          Error("keyed-time", fmt::format("key {} of the {} of joint {} at {} s is not after "
                                          "the previous key or not within 0 to {} s",
                                          k, what, joint, time, duration)),
          joint);
    }
    if (!is_sound(track.values[k]) ||
        (uses_velocities(track) && !track.velocities[k].allFinite())) {
      return in_joint(
          Error("keyed-value", fmt::format("key {} of the {} of joint {} is not finite or not a "
                                           "rotation",
                                           k, what, joint)),
          joint);
    }
  }
  return {};
}

}  // namespace

std::size_t KeyedClip::key_count() const {
  std::size_t count = 0;
  for (const KeyedJoint& joint : joints) {
    count += joint.position.times.size() + joint.rotation.times.size() + joint.scale.times.size();
  }
  return count;
}

void set_curve(VectorTrack& track, VectorCurve curve, double tension, Ends ends) {
  track.curve = curve;
  track.velocities.clear();
  if (!uses_velocities(track)) return;
  track.velocities.resize(track.times.size());
  if (curve == VectorCurve::hermite) {
    tension_velocities(track.times, track.values, tension, ends, track.velocities);
  } else {
    monotone_velocities(track.times, track.values, ends, track.velocities);
  }
}

void set_curve(RotationTrack& track, RotationCurve curve, double tension, Ends ends) {
  track.curve = curve;
  track.velocities.clear();
  if (!uses_velocities(track)) return;
  track.velocities.resize(track.times.size());
  squad_velocities(track.times, track.values, tension, ends, track.velocities);
}

Status check(const KeyedClip& clip) {
  if (Status status = check(clip.skeleton); !status) return status;
  if (clip.joints.size() != clip.skeleton.names.size()) {
    return Error("keyed-shape", fmt::format("keys for {} joints, the skeleton has {}",
                                            clip.joints.size(), clip.skeleton.names.size()));
  }
  if (!std::isfinite(clip.duration) || clip.duration < 0) {
    return Error("keyed-time", fmt::format("the duration is {} s", clip.duration));
  }
  for (std::size_t j = 0; j < clip.joints.size(); ++j) {
    const KeyedJoint& joint = clip.joints[j];
    const std::string& name = clip.skeleton.names[j];
    Status status = check_track(joint.position, "position", name, clip.duration);
    if (status) status = check_track(joint.rotation, "rotation", name, clip.duration);
    if (status) status = check_track(joint.scale, "scale", name, clip.duration);
    if (!status) return status;
  }
  return {};
}

KeyedClip keyed_clip(const Clip& clip) {
  KeyedClip keyed;
  keyed.skeleton = clip.skeleton;
  keyed.provenance = clip.provenance;
  keyed.duration = clip.duration();
  keyed.joints.resize(clip.skeleton.names.size());
  std::vector<Transform> world(keyed.joints.size()), local(keyed.joints.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, world);
    world_to_local(clip.skeleton.parents, world, local);
    // The last time equals the duration, however i / rate is rounded.
    const double time = f + 1 == clip.frame_count() ? keyed.duration : f / clip.rate;
    for (std::size_t j = 0; j < local.size(); ++j) {
      auto& [position, rotation, scale] = keyed.joints[j];
      position.times.push_back(time);
      position.values.push_back(local[j].position);
      const Quat before = rotation.values.empty() ? local[j].orientation : rotation.values.back();
      rotation.times.push_back(time);
      rotation.values.push_back(in_hemisphere_of(before, local[j].orientation));
    }
  }
  return keyed;
}

Result<Clip> uniform_clip(const KeyedClip& clip, double rate) {
  Clip result;
  result.skeleton = clip.skeleton;
  result.provenance = clip.provenance;
  result.rate = rate;
  const auto frames = frames_within(clip.duration, rate, clip.skeleton.joint_count());
  if (!frames) return frames.error();
  if (clip.skeleton.empty() || clip.key_count() == 0) return result;
  result.resize(*frames);
  std::vector<Transform> local(clip.joints.size()), world(local.size());
  std::vector<Vec3> scales(local.size());
  std::vector<Mat4> matrices(local.size());
  std::vector<KeyCursor> cursors(local.size());
  for (int f = 0; f < result.frame_count(); ++f) {
    sample_keys(clip, f / rate, Wrap::clamp, local, scales, cursors);
    scaled_local_to_world(clip.skeleton.parents, local, scales, matrices, world);
    for (Transform& joint : world) joint.orientation = normalized_or_identity(joint.orientation);
    result.set_pose(f, world);
  }
  return result;
}

Result<Clip> retime_on_curves(const Clip& clip, double rate, double speed, double tension,
                              bool keep_last) {
  if (!(speed > 0) || !std::isfinite(speed) || !(tension >= 0 && tension <= 1)) {
    return Error("motion-speed", "the speed must be positive, the tension from 0 to 1");
  }
  KeyedClip keyed = keyed_clip(clip);
  double span = keyed.duration / speed;
  if (keep_last && span > 0) span = std::max(1.0, std::round(span * rate)) / rate;
  const double scale = keyed.duration > 0 ? span / keyed.duration : 1;
  for (KeyedJoint& joint : keyed.joints) {
    for (auto* times : {&joint.position.times, &joint.rotation.times}) {
      for (double& time : *times) time = std::min(time * scale, span);
    }
    set_curve(joint.position, VectorCurve::hermite, tension);
    set_curve(joint.rotation, RotationCurve::squad, tension);
  }
  keyed.duration = span;
  return uniform_clip(keyed, rate);
}

}  // namespace krok
