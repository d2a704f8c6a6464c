#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>

#include "character/mesh.h"
#include "character/mesh_internal.h"
#include "core/hash.h"
#include "core/index.h"
#include "core/text.h"

namespace krok::character {

namespace {

// The weight of a node's target without animation.
double resting(const nodes::Scene& scene, const SceneActor::WeightSource& source) {
  const nodes::Node& node = scene.nodes[at(source.node)];
  const auto& weights = node.weights.empty() ? scene.meshes[at(node.mesh)].weights : node.weights;
  return weights[at(source.target)];
}

template <typename T>
void feed(Xxh3Stream& stream, T value) {
  value += T(0);  // -0 is 0
  stream.update(std::as_bytes(std::span(&value, 1)));
}

}  // namespace

TargetNames::TargetNames(const nodes::Scene& scene, const nodes::Evaluator& evaluator)
    : scene_(scene), evaluator_(evaluator) {
  for (const nodes::Animation& animation : scene.animations) {
    auto& by_node = channels_.emplace_back();
    for (const nodes::Channel& channel : animation.channels) {
      if (channel.path == nodes::Path::weights) by_node.emplace(channel.node, &channel);
    }
  }
}

std::vector<const nodes::Channel*> TargetNames::channels_of(int node) const {
  std::vector<const nodes::Channel*> found;
  for (const auto& by_node : channels_) {
    const auto channel = by_node.find(node);
    found.push_back(channel == by_node.end() ? nullptr : channel->second);
  }
  return found;
}

std::uint64_t TargetNames::fingerprint(const SceneActor::WeightSource& source) const {
  Xxh3Stream stream;
  feed(stream, resting(scene_, source));
  for (const nodes::Channel* channel : channels_of(source.node)) {
    feed(stream, channel == nullptr ? 0 : 1);
    if (channel == nullptr) continue;
    const auto width = at(channel->width);
    for (std::size_t k = 0; k < channel->values->size() / width; ++k) {
      feed(stream, (*channel->values)[k * width + at(source.target)]);
    }
  }
  return stream.digest();
}

// Whether the weights are the same without animation, and have the same keys in each animation.
bool TargetNames::same_weights(const SceneActor::WeightSource& a,
                               const SceneActor::WeightSource& b) const {
  if (resting(scene_, a) != resting(scene_, b)) return false;
  const auto channels = channels_of(a.node), others = channels_of(b.node);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const nodes::Channel* one = channels[i];
    const nodes::Channel* other = others[i];
    if (one == nullptr && other == nullptr) continue;
    if (one == nullptr || other == nullptr || one->interpolation != other->interpolation ||
        *one->times != *other->times) {
      return false;
    }
    const auto one_width = at(one->width), other_width = at(other->width);
    const std::size_t keys = one->values->size() / one_width;
    for (std::size_t k = 0; k < keys; ++k) {
      if ((*one->values)[k * one_width + at(a.target)] !=
          (*other->values)[k * other_width + at(b.target)]) {
        return false;
      }
    }
  }
  return true;
}

void TargetNames::add(const nodes::Instance& instance) {
  const nodes::Primitive& shape = evaluator_.primitive(instance);
  const nodes::Mesh& mesh = scene_.meshes[at(instance.mesh)];
  for (int k = 0; k < static_cast<int>(shape.targets.size()); ++k) {
    const SceneActor::WeightSource source{instance.node, k};
    if (indices_.contains({instance.node, k})) continue;  // an earlier primitive of the mesh
    std::string name = to_utf8(shape.targets[at(k)].name);
    if (name.empty()) {
      name = fmt::format("{}_{}", mesh.name.empty() ? "target" : to_utf8(mesh.name), k);
    }
    std::vector<int>& named = by_name_[{name, fingerprint(source)}];
    const auto same = std::find_if(named.begin(), named.end(), [&](int target) {
      return sources_[at(target)].node != instance.node &&
             same_weights(sources_[at(target)], source);
    });
    if (same != named.end()) {
      indices_[{instance.node, k}] = *same;
      continue;
    }
    const int index = static_cast<int>(names_.size());
    indices_[{instance.node, k}] = index;
    named.push_back(index);
    names_.push_back(unique_.make(name));
    sources_.push_back(source);
  }
}

Result<MorphWeights> make_weights(const SceneActor& actor, const nodes::Evaluator& evaluator,
                                  int animation, const Sampling& sampling) {
  constexpr std::size_t kMax = 100'000'000;
  const std::size_t targets = actor.weight_sources.size();
  if (targets > 0 && at(sampling.frames) > kMax / targets) {
    return Error("scene-too-long",
                 fmt::format("{} frames of {} morph weights exceed the limit of 100 million",
                             sampling.frames, targets),
                 "use --rate N for a lower frame rate");
  }
  MorphWeights weights;
  weights.rate = sampling.rate;
  weights.names = actor.morphs.names;
  weights.values.reserve(at(sampling.frames) * targets);
  nodes::Evaluation state;
  for (int frame = 0; frame < sampling.frames; ++frame) {
    evaluator.place_nodes(animation, sampling.time(frame), state);
    for (const SceneActor::WeightSource& source : actor.weight_sources) {
      weights.values.push_back(
          static_cast<float>(state.node_weights[at(source.node)][at(source.target)]));
    }
  }
  return weights;
}

Mat3 normal_matrix(const Mat3& linear) {
  Mat3 result;
  for (int c = 0; c < 3; ++c) {
    result.col(c) = linear.col((c + 1) % 3).cross(linear.col((c + 2) % 3));
  }
  return linear.determinant() < 0 ? Mat3(-result) : result;
}

Placements::Placements(const nodes::Scene& scene, const nodes::Evaluator& evaluator, const Rig& rig,
                       const Conversion& conversion)
    : scene_(scene), evaluator_(evaluator), rig_(rig) {
  to_krok_ = Affine::Zero();
  to_krok_.leftCols<3>() = conversion.reference_axes() * conversion.metres();
  evaluator.place_nodes(-1, 0, rest_);
}

bool Placements::is_skinned(const nodes::Instance& instance) const {
  return scene_.nodes[at(instance.node)].skin >= 0 &&
         evaluator_.primitive(instance).influences_per_vertex > 0;
}

// sum_j w_j F_j B_j.
void Placements::find(const nodes::Instance& instance) {
  const nodes::Primitive& shape = evaluator_.primitive(instance);
  const auto in_krok = [&](const Mat4& to_rig) -> Affine {
    return to_krok_.leftCols<3>() * to_rig.topRows<3>();
  };
  placements_.clear();
  if (!is_skinned(instance)) {
    const int joint = rig_.joints.node_to_joint[at(instance.node)];
    const int joint_node = rig_.joints.nodes[at(joint)];
    const Mat4 node_to_world = rig_.to_axes * rest_.node_to_world[at(instance.node)];
    bool usable = joint_node >= 0;
    const Mat4 back =
        usable ? inverse_or_identity(rig_.to_axes * rest_.node_to_world[at(joint_node)], &usable)
               : Mat4::Identity();
    placements_.push_back(
        in_krok(usable ? Mat4(rig_.reference[at(joint)] * (back * node_to_world)) : node_to_world));
    return;
  }
  const nodes::Skin& skin = scene_.skins[at(scene_.nodes[at(instance.node)].skin)];
  std::vector<Affine> palette;
  const Mat4* first = nullptr;
  std::vector<Mat4> whole;
  for (std::size_t k = 0; k < skin.joints.size(); ++k) {
    const int joint = rig_.joints.node_to_joint[at(skin.joints[k])];
    whole.push_back(rig_.reference[at(joint)] * skin.inverse_binds[k]);
  }
  // Usually all joints agree: then one transform is enough for all, without the rounding of the
  // blend.
  bool agree = true;
  const auto per_vertex = static_cast<std::size_t>(shape.influences_per_vertex);
  for (std::size_t k = 0; k < shape.influence_joints.size() && agree; ++k) {
    if (!(shape.influence_weights[k] > 0)) continue;
    const Mat4& one = whole[shape.influence_joints[k]];
    if (first == nullptr) first = &one;
    agree = (one - *first).cwiseAbs().maxCoeff() <= 1e-9 * (1 + first->cwiseAbs().maxCoeff());
  }
  if (agree && first != nullptr) {
    placements_.push_back(in_krok(*first));
    return;
  }
  for (const Mat4& one : whole) palette.push_back(in_krok(one));
  placements_.resize(shape.vertex_count());
  for (std::size_t v = 0; v < placements_.size(); ++v) {
    placements_[v].setZero();
    for (std::size_t k = v * per_vertex; k < (v + 1) * per_vertex; ++k) {
      placements_[v] +=
          static_cast<double>(shape.influence_weights[k]) * palette[shape.influence_joints[k]];
    }
  }
}

void make_missing_normals(Model& model) {
  std::vector<Vec3> sums(model.positions.size(), Vec3::Zero());
  for (const auto& corners : model.triangles) {
    const auto corner = [&](int k) -> Vec3 { return model.positions[corners[k]].cast<double>(); };
    const Vec3 area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (const std::uint32_t one : corners) sums[one] += area;
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    Vec3f& normal = model.normals[v];
    if (normal.squaredNorm() > 0.5f) continue;
    const double length = sums[v].stableNorm();
    normal = length > 0 && std::isfinite(length) ? Vec3f((sums[v] / length).cast<float>())
                                                 : Vec3f(Vec3f::UnitY());
  }
}

bool same_vertices(const nodes::Primitive& a, const nodes::Primitive& b) {
  const auto same_target = [](const nodes::MorphTarget& first, const nodes::MorphTarget& second) {
    return first.positions == second.positions && first.normals == second.normals;
  };
  return a.positions == b.positions && a.normals == b.normals && a.tangents == b.tangents &&
         a.texture_coordinates == b.texture_coordinates &&
         a.more_texture_coordinates == b.more_texture_coordinates && a.colours == b.colours &&
         a.influences_per_vertex == b.influences_per_vertex &&
         std::ranges::equal(a.targets, b.targets, same_target) &&
         a.influence_joints == b.influence_joints && a.influence_weights == b.influence_weights;
}

}  // namespace krok::character
