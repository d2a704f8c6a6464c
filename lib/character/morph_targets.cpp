#include <fmt/format.h>

#include <algorithm>
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

}  // namespace krok::character
