#include <assimp/anim.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "formats/assimp/conversion_internal.h"
#include "math/quaternion.h"

namespace krok::assimp {

namespace {

// Assimp's keys, sorted and cleaned.

// Keys of one property; times in seconds, increasing after tidy().
template <typename Value>
struct Track {
  std::vector<double> times;
  std::vector<Value> values;

  bool empty() const { return times.empty(); }
};
using VectorTrack = Track<Vec3>;
using RotationTrack = Track<Quat>;

struct KeyFaults {
  std::size_t not_finite = 0;
  std::size_t out_of_order = 0;
  std::size_t same_time = 0;
};

inline Vec3 between(const Vec3& a, const Vec3& b, double t) {
  return a + t * (b - a);
}
inline Quat between(const Quat& a, const Quat& b, double t) {
  return slerp(a, b, t);
}
inline double between(double a, double b, double t) {
  return a + t * (b - a);
}

// The value at a time, clamped to the first and last key. The track must not be empty.
template <typename Value>
Value sample_track(const Track<Value>& track, double time) {
  const auto after = std::upper_bound(track.times.begin(), track.times.end(), time);
  const auto k = static_cast<std::size_t>(after - track.times.begin());
  if (k == 0) return track.values.front();
  if (k == track.times.size()) return track.values.back();
  const double t = (time - track.times[k - 1]) / (track.times[k] - track.times[k - 1]);
  return between(track.values[k - 1], track.values[k], t);
}

// Sorts keys by time and keeps the last of those at the same time, compared as floats.
template <typename Value>
void tidy(Track<Value>& track, KeyFaults& faults) {
  std::vector<std::size_t> order(track.times.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  if (!std::is_sorted(track.times.begin(), track.times.end())) {
    ++faults.out_of_order;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return track.times[a] < track.times[b]; });
  }
  Track<Value> tidied;
  for (const std::size_t k : order) {
    const bool same = !tidied.empty() &&
                      static_cast<float>(track.times[k]) <= static_cast<float>(tidied.times.back());
    if (same) {
      ++faults.same_time;
      tidied.values.back() = track.values[k];
    } else {
      tidied.times.push_back(track.times[k]);
      tidied.values.push_back(track.values[k]);
    }
  }
  track = std::move(tidied);
}

// Removes what is before time 0 and adds a key at 0.
template <typename Value>
void begin_at_zero(Track<Value>& track) {
  if (track.empty() || track.times.front() >= 0) return;
  const Value at_zero = sample_track(track, 0.0);
  Track<Value> cut;
  cut.times.push_back(0.0);
  cut.values.push_back(at_zero);
  for (std::size_t k = 0; k < track.times.size(); ++k) {
    if (static_cast<float>(track.times[k]) <= 0) continue;
    cut.times.push_back(track.times[k]);
    cut.values.push_back(track.values[k]);
  }
  track = std::move(cut);
}

// Keys with a time or value that is not finite, or absurdly large, are left out.
VectorTrack vector_track(const aiVectorKey* keys, unsigned count, double seconds_per_tick,
                         KeyFaults& faults) {
  VectorTrack track;
  for (unsigned k = 0; k < count; ++k) {
    const double time = keys[k].mTime * seconds_per_tick;
    const Vec3 value = to_vector(keys[k].mValue);
    if (!std::isfinite(time) || std::abs(time) > 1e9 || !value.allFinite()) {
      ++faults.not_finite;
      continue;
    }
    track.times.push_back(time);
    track.values.push_back(value);
  }
  tidy(track, faults);
  return track;
}

RotationTrack rotation_track(const aiQuatKey* keys, unsigned count, double seconds_per_tick,
                             KeyFaults& faults) {
  RotationTrack track;
  for (unsigned k = 0; k < count; ++k) {
    const double time = keys[k].mTime * seconds_per_tick;
    const aiQuaternion& q = keys[k].mValue;
    const Quat value(static_cast<double>(q.w), static_cast<double>(q.x), static_cast<double>(q.y),
                     static_cast<double>(q.z));
    const double length = value.norm();
    if (!std::isfinite(time) || std::abs(time) > 1e9 || !(length > 1e-6) ||
        !std::isfinite(length)) {
      ++faults.not_finite;
      continue;
    }
    track.times.push_back(time);
    track.values.push_back(normalized_or_identity(value));
  }
  tidy(track, faults);
  return track;
}

}  // namespace

using namespace nodes;
using registry::Kind;

namespace {

struct NodeTracks {
  VectorTrack translation;
  RotationTrack rotation;
  VectorTrack scale;
};

// Assimp's channels that animate one of our nodes.
struct NodeSource {
  const aiNodeAnim* whole = nullptr;
  std::map<std::string, const aiNodeAnim*> of_part;  // by the helper node's name
};

class AnimationBuilder {
 public:
  AnimationBuilder(Conversion& to, const aiAnimation& source) : to_(to), source_(source) {}

  Animation build();
  const KeyFaults& faults() const { return faults_; }
  std::size_t unknown_nodes() const { return unknown_nodes_; }

 private:
  std::map<int, NodeSource> sources();
  NodeTracks whole_tracks(const aiNodeAnim& source);
  NodeTracks chain_tracks(const std::vector<ChainPart>& parts, const NodeSource& source);
  void undo_wrong_post_rotation(int node, RotationTrack& rotation);
  void turn_displacements(int node, VectorTrack& translation);
  void add_channels(int node, NodeTracks tracks);
  template <typename Value>
  void add_channel(int node, Path path, const Track<Value>& track, const Value& at_rest);
  template <typename Value>
  void push_channel(int node, Path path, int width, const Track<Value>& track);
  int morphed_node(const aiMeshMorphAnim& source);
  Track<std::vector<double>> weights_track(const aiMeshMorphAnim& source,
                                           const std::vector<double>& at_rest);
  void add_weights(const aiMeshMorphAnim& source);

  Conversion& to_;
  const aiAnimation& source_;
  double seconds_ = 1.0;  // per tick
  Animation animation_;
  KeyFaults faults_;
  std::size_t unknown_nodes_ = 0;
};

std::map<int, NodeSource> AnimationBuilder::sources() {
  std::map<int, NodeSource> sources;
  for (unsigned c = 0; c < source_.mNumChannels; ++c) {
    const aiNodeAnim* channel = source_.mChannels[c];
    const std::string name = to_text(channel->mNodeName);
    const auto part = to_.node_of_chain_part.find(name);
    const auto node = to_.node_by_name.find(name);
    if (part != to_.node_of_chain_part.end()) {
      sources[part->second].of_part.emplace(name, channel);
    } else if (node != to_.node_by_name.end()) {
      NodeSource& entry = sources[node->second];
      if (entry.whole == nullptr) entry.whole = channel;
    } else {
      ++unknown_nodes_;
    }
  }
  return sources;
}

// 3DS: a key's rotation is relative to the key before, about axes of the parent; Assimp 5.2
// multiplies them as if the axes turned with the object, d1 d2 d3 for d3 d2 d1.
void reverse_products(std::vector<aiQuatKey>& keys) {
  aiQuaternion before, product;
  for (aiQuatKey& key : keys) {
    product = aiQuaternion(before).Conjugate() * key.mValue * product;
    before = key.mValue;
    key.mValue = product;
  }
}

NodeTracks AnimationBuilder::whole_tracks(const aiNodeAnim& source) {
  NodeTracks tracks;
  tracks.translation =
      vector_track(source.mPositionKeys, source.mNumPositionKeys, seconds_, faults_);
  std::vector<aiQuatKey> rotations(source.mRotationKeys,
                                   source.mRotationKeys + source.mNumRotationKeys);
  if (to_.kind == Kind::max_3ds) reverse_products(rotations);
  tracks.rotation = rotation_track(rotations.data(), source.mNumRotationKeys, seconds_, faults_);
  tracks.scale = vector_track(source.mScalingKeys, source.mNumScalingKeys, seconds_, faults_);
  return tracks;
}

// MilkShape: a joint's transform is rest * key, so a key's translation is in the joint's axes;
// Assimp 5.2 adds it in the parent's axes.
void AnimationBuilder::turn_displacements(int node, VectorTrack& translation) {
  const Node& rest = to_.scene.nodes[static_cast<std::size_t>(node)];
  for (Vec3& value : translation.values) {
    value = rest.translation + rest.rotation * (value - rest.translation);
  }
}

// A node whose transform is a product of animated parts: evaluated and decomposed at each time at
// which any part has a key.
NodeTracks AnimationBuilder::chain_tracks(const std::vector<ChainPart>& parts,
                                          const NodeSource& source) {
  struct Moving {
    VectorTrack vectors;
    RotationTrack rotations;
    bool scales = false;
  };
  std::map<std::string, Moving> moving;
  std::set<double> times;
  for (const auto& [name, channel] : source.of_part) {
    Moving& part = moving[name];
    const std::string_view component = std::string_view(name).substr(name.rfind('_') + 1);
    if (component.ends_with("Rotation")) {
      part.rotations =
          rotation_track(channel->mRotationKeys, channel->mNumRotationKeys, seconds_, faults_);
      times.insert(part.rotations.times.begin(), part.rotations.times.end());
    } else {
      part.scales = component == "Scaling";
      part.vectors =
          part.scales
              ? vector_track(channel->mScalingKeys, channel->mNumScalingKeys, seconds_, faults_)
              : vector_track(channel->mPositionKeys, channel->mNumPositionKeys, seconds_, faults_);
      times.insert(part.vectors.times.begin(), part.vectors.times.end());
    }
  }
  NodeTracks tracks;
  for (const double time : times) {
    Mat4 product = Mat4::Identity();
    for (const ChainPart& part : parts) {
      Mat4 matrix = part.matrix;
      const auto found = moving.find(part.name);
      if (found != moving.end() && !found->second.rotations.empty()) {
        matrix.setIdentity();
        matrix.topLeftCorner<3, 3>() =
            sample_track(found->second.rotations, time).toRotationMatrix();
      } else if (found != moving.end() && !found->second.vectors.empty()) {
        const Vec3 value = sample_track(found->second.vectors, time);
        matrix.setIdentity();
        if (found->second.scales) {
          matrix.topLeftCorner<3, 3>() = value.asDiagonal();
        } else {
          matrix.topRightCorner<3, 1>() = value;
        }
      }
      product = product * matrix;
    }
    Vec3 translation, scale;
    Quat rotation;
    take_apart(product, translation, rotation, scale);
    tracks.translation.times.push_back(time);
    tracks.translation.values.push_back(translation);
    tracks.rotation.times.push_back(time);
    tracks.rotation.values.push_back(rotation);
    tracks.scale.times.push_back(time);
    tracks.scale.values.push_back(scale);
  }
  return tracks;
}

// For a node with a PostRotation Q and no pivots, Assimp 5.2 computes the animated rotation as
// P R Q; FBX defines P R Q^-1, which Assimp's helper node has.
void AnimationBuilder::undo_wrong_post_rotation(int node, RotationTrack& rotation) {
  const auto chain = to_.chain_of.find(node);
  if (chain == to_.chain_of.end()) return;
  for (const ChainPart& part : chain->second) {
    if (part.component != "PostRotation") continue;
    const Quat inverse(Mat3(part.matrix.topLeftCorner<3, 3>()));
    for (Quat& q : rotation.values) q = normalized_or_identity(q * inverse * inverse);
  }
}

// Appends the values of a key.
void append(std::vector<float>& values, const Vec3& value) {
  for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(value[k]));
}
void append(std::vector<float>& values, const Quat& value) {
  for (int k = 0; k < 4; ++k) values.push_back(static_cast<float>(value.coeffs()[k]));
}
void append(std::vector<float>& values, const std::vector<double>& value) {
  for (const double number : value) values.push_back(static_cast<float>(number));
}

bool nearly(const Vec3& a, const Vec3& b) {
  return (a - b).norm() <= 1e-6 * std::max(1.0, b.norm());
}
bool nearly(const Quat& a, const Quat& b) {
  return angle_between(a, b) < 1e-6;
}

template <typename Value>
void AnimationBuilder::push_channel(int node, Path path, int width, const Track<Value>& track) {
  Channel channel;
  channel.node = node;
  channel.path = path;
  channel.width = width;
  std::vector<float> times, values;
  for (const double time : track.times) times.push_back(static_cast<float>(time));
  for (const Value& value : track.values) append(values, value);
  channel.times = std::make_shared<const std::vector<float>>(std::move(times));
  channel.values = std::make_shared<const std::vector<float>>(std::move(values));
  animation_.channels.push_back(std::move(channel));
}

template <typename Value>
void AnimationBuilder::add_channel(int node, Path path, const Track<Value>& track,
                                   const Value& at_rest) {
  // Importers add constant tracks.
  const bool moves = std::any_of(track.values.begin(), track.values.end(),
                                 [&](const Value& value) { return !nearly(value, at_rest); });
  if (!moves && track.times.size() < 2) return;
  push_channel(node, path, path == Path::rotation ? 4 : 3, track);
}

void AnimationBuilder::add_channels(int node, NodeTracks tracks) {
  begin_at_zero(tracks.translation);
  begin_at_zero(tracks.rotation);
  begin_at_zero(tracks.scale);
  const Node& rest = to_.scene.nodes[static_cast<std::size_t>(node)];
  add_channel(node, Path::translation, tracks.translation, rest.translation);
  add_channel(node, Path::rotation, tracks.rotation, rest.rotation);
  add_channel(node, Path::scale, tracks.scale, rest.scale);
}

// The node whose mesh the channel animates; -1 if there is none.
int AnimationBuilder::morphed_node(const aiMeshMorphAnim& source) {
  std::string name = to_text(source.mName);
  auto found = to_.node_by_name.find(name);
  if (found == to_.node_by_name.end() && name.rfind('*') != std::string::npos) {
    found = to_.node_by_name.find(name.substr(0, name.rfind('*')));  // FBX: <node>*<geometry>
  }
  if (found == to_.node_by_name.end()) {
    ++unknown_nodes_;
    return -1;
  }
  int node = found->second;
  if (to_.scene.nodes[static_cast<std::size_t>(node)].mesh == -1) {
    const std::string geometry = to_.scene.nodes[static_cast<std::size_t>(node)].name + "_geometry";
    const auto below = to_.node_by_name.find(geometry);
    if (below != to_.node_by_name.end()) node = below->second;
  }
  return to_.scene.nodes[static_cast<std::size_t>(node)].mesh == -1 ? -1 : node;
}

// All targets' weights at each time at which any has a key. A key lists only the targets that have
// a key at its time.
Track<std::vector<double>> AnimationBuilder::weights_track(const aiMeshMorphAnim& source,
                                                           const std::vector<double>& at_rest) {
  std::vector<Track<double>> of_target(at_rest.size());
  std::set<double> times;
  for (unsigned k = 0; k < source.mNumKeys; ++k) {
    const aiMeshMorphKey& key = source.mKeys[k];
    const double time = key.mTime * seconds_;
    if (!std::isfinite(time) || std::abs(time) > 1e9) continue;
    for (unsigned i = 0; i < key.mNumValuesAndWeights; ++i) {
      if (key.mValues[i] >= of_target.size() || !std::isfinite(key.mWeights[i])) continue;
      Track<double>& track = of_target[key.mValues[i]];
      track.times.push_back(time);
      track.values.push_back(key.mWeights[i]);
    }
    times.insert(time);
  }
  Track<std::vector<double>> track;
  for (Track<double>& target : of_target) {
    tidy(target, faults_);
    begin_at_zero(target);
  }
  for (const double time : times) {
    if (time < 0) continue;
    std::vector<double> weights = at_rest;
    for (std::size_t t = 0; t < weights.size(); ++t) {
      if (!of_target[t].empty()) weights[t] = sample_track(of_target[t], time);
    }
    const bool same =
        !track.empty() && static_cast<float>(time) <= static_cast<float>(track.times.back());
    if (same) continue;
    track.times.push_back(time);
    track.values.push_back(std::move(weights));
  }
  return track;
}

void AnimationBuilder::add_weights(const aiMeshMorphAnim& source) {
  const int node = morphed_node(source);
  if (node == -1) return;
  const int mesh = to_.scene.nodes[static_cast<std::size_t>(node)].mesh;
  const std::vector<double>& at_rest = to_.scene.meshes[static_cast<std::size_t>(mesh)].weights;
  if (at_rest.empty()) return;
  const auto track = weights_track(source, at_rest);
  if (!track.empty()) push_channel(node, Path::weights, static_cast<int>(at_rest.size()), track);
}

Animation AnimationBuilder::build() {
  animation_.name = to_text(source_.mName);
  double rate = source_.mTicksPerSecond;
  if (to_.kind == Kind::smd) rate = to_.frames_per_second;
  if (!(rate > 0) || !std::isfinite(rate)) {
    rate = 25.0;
    to_.warn("assimp-ticks",
             fmt::format("the file does not specify the tick rate of animation '{}'; 25 ticks "
                         "per second are assumed",
                         animation_.name));
  }
  seconds_ = 1.0 / rate;
  for (const auto& [node, source] : sources()) {
    NodeTracks tracks;
    if (source.whole != nullptr) {
      tracks = whole_tracks(*source.whole);
      undo_wrong_post_rotation(node, tracks.rotation);
      if (to_.kind == Kind::ms3d) turn_displacements(node, tracks.translation);
    } else {
      tracks = chain_tracks(to_.chain_of.at(node), source);
    }
    add_channels(node, std::move(tracks));
  }
  for (unsigned m = 0; m < source_.mNumMorphMeshChannels; ++m) {
    add_weights(*source_.mMorphMeshChannels[m]);
  }
  return std::move(animation_);
}

void report(Conversion& to, const std::string& name, const AnimationBuilder& builder) {
  if (builder.unknown_nodes() > 0) {
    to.warn("assimp-animation-node",
            fmt::format("animation '{}' animates {} nodes that do not exist; they are ignored",
                        name, builder.unknown_nodes()));
  }
  if (builder.faults().not_finite > 0) {
    to.warn("assimp-keys", fmt::format("{} keys of animation '{}' are not finite and are left out",
                                       builder.faults().not_finite, name));
  }
  if (builder.faults().out_of_order > 0) {
    to.warn("assimp-keys", fmt::format("keys of animation '{}' are not in time order; they were "
                                       "sorted",
                                       name));
  }
  if (builder.faults().same_time > 0) {
    to.note("assimp-keys", fmt::format("{} keys of animation '{}' are at the same time as another; "
                                       "the last one is kept",
                                       builder.faults().same_time, name));
  }
}

std::size_t longest(const Animation& animation) {
  std::size_t keys = 0;
  for (const Channel& channel : animation.channels) keys = std::max(keys, channel.times->size());
  return keys;
}

}  // namespace

void convert_animations(Conversion& to, const aiScene& source) {
  for (unsigned a = 0; a < source.mNumAnimations; ++a) {
    AnimationBuilder builder(to, *source.mAnimations[a]);
    Animation animation = builder.build();
    report(to, animation.name, builder);
    // In an SMD with a mesh, the skeleton is a pose, not a motion.
    const bool pose =
        to.kind == Kind::smd && a == 0 && !to.scene.meshes.empty() && longest(animation) < 2;
    if (!animation.channels.empty() && !pose) to.scene.animations.push_back(std::move(animation));
  }
}

}  // namespace krok::assimp
