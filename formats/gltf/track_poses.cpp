#include "formats/gltf/joint_tracks.h"

#include <algorithm>

#include "math/quaternion.h"

namespace krok::gltf {

namespace {

// Two keys and the share of the second.
struct KeyPlace {
  std::size_t before = 0, after = 0;
  double share = 0;
};

// `frames` are those of the keys, or none for one per frame.
KeyPlace key_place(const std::vector<int>& frames, std::size_t keys, double frame) {
  if (frames.empty()) {
    const auto before = std::min(static_cast<std::size_t>(std::max(frame, 0.0)), keys - 1);
    const std::size_t after = std::min(before + 1, keys - 1);
    return {before, after, after > before ? frame - static_cast<double>(before) : 0.0};
  }
  const auto next = std::upper_bound(frames.begin(), frames.end(), frame);
  if (next == frames.begin()) return {};
  const auto before = static_cast<std::size_t>(next - frames.begin()) - 1;
  if (next == frames.end()) return {before, before, 0};
  return {before, before + 1, (frame - frames[before]) / (*next - frames[before])};
}

Vec3 vector_at(const std::vector<Vec3f>& keys, const std::vector<int>& frames, double frame,
               const Vec3f& rest) {
  if (keys.empty()) return rest.cast<double>();
  const KeyPlace place = key_place(frames, keys.size(), frame);
  const Vec3 from = keys[place.before].cast<double>();
  return from + place.share * (keys[place.after].cast<double>() - from);
}

Quat rotation_at(const std::vector<Quatf>& keys, const std::vector<int>& frames, double frame,
                 const Quatf& rest) {
  if (keys.empty()) return normalized_or_identity(rest.cast<double>());
  const KeyPlace place = key_place(frames, keys.size(), frame);
  const Quat from = normalized_or_identity(keys[place.before].cast<double>());
  if (!(place.share > 0)) return from;
  return slerp(from, normalized_or_identity(keys[place.after].cast<double>()), place.share);
}

}  // namespace

void TrackPoses::at(double frame, std::span<Mat4> joint_to_world) const {
  for (std::size_t j = 0; j < joint_to_world.size(); ++j) {
    const JointTrack& track = tracks_.joints[j];
    Mat4 local = Mat4::Identity();
    local.topRightCorner<3, 1>() =
        vector_at(track.translations, track.translation_frames, frame, track.rest_translation);
    Mat3 linear = rotation_at(track.rotations, track.rotation_frames, frame, track.rest_rotation)
                      .toRotationMatrix();
    if (!track.scales.empty()) {
      linear = linear * vector_at(track.scales, {}, frame, Vec3f::Ones()).asDiagonal();
    }
    if (!track.inner_rotations.empty()) {
      linear = linear *
               rotation_at(track.inner_rotations, {}, frame, Quatf::Identity()).toRotationMatrix();
    }
    local.topLeftCorner<3, 3>() = linear;
    const int parent = parents_[j];
    joint_to_world[j] =
        parent < 0 ? local : Mat4(joint_to_world[static_cast<std::size_t>(parent)] * local);
  }
}

}  // namespace krok::gltf
