#include "formats/gltf/joint_tracks.h"

#include <algorithm>
#include <cassert>

#include "math/quaternion.h"

namespace krok::gltf {

namespace {

// joint_to_parent of all frames as a viewer computes it, [frames x joints].
std::vector<Transform> local_transforms(const JointTracks& tracks) {
  const std::size_t joints = tracks.joints.size(), frames = tracks.times.size();
  std::vector<Transform> local(joints * frames);
  for (std::size_t j = 0; j < joints; ++j) {
    const JointTrack& track = tracks.joints[j];
    assert(track.translation_frames.empty() && track.rotation_frames.empty());
    for (std::size_t f = 0; f < frames; ++f) {
      const Vec3f& position =
          track.translations.empty() ? track.rest_translation : track.translations[f];
      const Quatf& rotation = track.rotations.empty() ? track.rest_rotation : track.rotations[f];
      local[f * joints + j] = {position.cast<double>(),
                               normalized_or_identity(rotation.cast<double>())};
    }
  }
  return local;
}

template <typename Value>
void keep(const std::vector<int>& frames, std::vector<Value>& values, std::vector<int>& kept) {
  if (values.empty() || frames.size() == values.size()) return;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    values[k] = values[static_cast<std::size_t>(frames[k])];
  }
  values.resize(frames.size());
  kept = frames;
}

// Without any key at the last frame the animation would end early: adds one to the first track.
void lengthen(int last, std::vector<KeptFrames>& joints) {
  std::vector<int>* first = nullptr;
  for (KeptFrames& joint : joints) {
    for (std::vector<int>* frames : {&joint.position, &joint.rotation}) {
      if (frames->empty()) continue;
      if (frames->back() == last) return;
      if (first == nullptr) first = frames;
    }
  }
  if (first != nullptr) first->push_back(last);
}

}  // namespace

Result<Reduction> reduce_tracks(const Skeleton& rest, const ReduceOptions& options, int jobs,
                                JointTracks& tracks) {
  if (tracks.are_stretched()) {
    return Error("reduce-stretch", "keys of joints that change scale cannot be reduced");
  }
  const std::vector<double> times(tracks.times.begin(), tracks.times.end());
  // A translation key takes 12 bytes, a rotation key 16, its time 4 unless the track shares the
  // times of all frames, and the JSON of a time accessor some 120.
  ReduceOptions smallest = options;
  smallest.most_kept =
      std::max(0.0, std::min(options.most_kept, 0.75 - 10.0 / static_cast<double>(times.size())));
  std::vector<Transform> still;
  for (const JointTrack& track : tracks.joints) {
    still.push_back({track.rest_translation.cast<double>(),
                     normalized_or_identity(track.rest_rotation.cast<double>())});
  }
  smallest.rest = still;
  auto reduction = choose_keys(rest.parents, times, local_transforms(tracks), smallest, jobs);
  if (!reduction || times.empty()) return reduction;
  const int last = static_cast<int>(times.size()) - 1;
  lengthen(last, reduction->joints);
  reduction->keys_before = reduction->keys_after = 0;
  for (std::size_t j = 0; j < tracks.joints.size(); ++j) {
    const KeptFrames& kept = reduction->joints[j];
    JointTrack& track = tracks.joints[j];
    reduction->keys_before += track.translations.size() + track.rotations.size();
    keep(kept.position, track.translations, track.translation_frames);
    keep(kept.rotation, track.rotations, track.rotation_frames);
    for (std::size_t k = 1; k < track.rotations.size(); ++k) {
      Quatf& rotation = track.rotations[k];
      if (track.rotations[k - 1].dot(rotation) < 0) rotation.coeffs() = -rotation.coeffs();
    }
    reduction->keys_after += track.translations.size() + track.rotations.size();
  }
  return reduction;
}

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
