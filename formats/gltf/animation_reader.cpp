#include "formats/gltf/reader_internal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::gltf {

using namespace nodes;

namespace {

class Reader {
 public:
  Reader(Accessors& accessors, Scene& scene) : accessors_(accessors), scene_(scene) {}

  Status read_channel(const tinygltf::Animation& source, std::size_t index, std::size_t channel,
                      Animation& animation);
  // False if the channel is not read.
  Result<bool> read_lens(const tinygltf::Animation& source, const PointerChannel& pointer,
                         Animation& animation);
  void report_repeated();

 private:
  Status read_keys(const tinygltf::AnimationSampler& sampler, const std::string& name,
                   Channel& channel);

  void keep_last_of_each_time(const tinygltf::AnimationSampler& sampler, Channel& channel,
                              std::size_t repeated);

  Accessors& accessors_;
  Scene& scene_;
  // What is left of accessors: of times, and of values by those and their own.
  std::map<int, Shared<float>> times_;
  std::map<std::pair<int, int>, Shared<float>> values_;
  std::size_t repeated_ = 0;
};

Status Reader::read_channel(const tinygltf::Animation& source, std::size_t index,
                            std::size_t channel_index, Animation& animation) {
  const tinygltf::AnimationChannel& from = source.channels[channel_index];
  const std::string name =
      fmt::format("{}, channel {}", label("animation", index, source.name), channel_index);
  if (from.target_node < 0) return {};  // ignored, as the specification requires
  if (!exists(from.target_node, scene_.nodes.size())) {
    return Error("gltf-animation",
                 fmt::format("{} targets node {}, which does not exist", name, from.target_node));
  }
  if (!exists(from.sampler, source.samplers.size())) {
    return Error("gltf-animation",
                 fmt::format("{} references sampler {}, which does not exist", name, from.sampler));
  }
  Channel channel;
  channel.node = from.target_node;
  const Node& node = scene_.nodes[static_cast<std::size_t>(channel.node)];
  const Node& holder =  // of the mesh
      node.instances.empty() ? node : scene_.nodes[static_cast<std::size_t>(node.instances[0])];
  if (from.target_path == "translation") {
    channel.path = Path::translation;
  } else if (from.target_path == "rotation") {
    channel.path = Path::rotation;
    channel.width = 4;
  } else if (from.target_path == "scale") {
    channel.path = Path::scale;
  } else if (from.target_path == "weights") {
    channel.path = Path::weights;
    const std::size_t targets =
        holder.mesh < 0 ? 0 : scene_.meshes[static_cast<std::size_t>(holder.mesh)].target_count();
    if (targets == 0) {
      return Error("gltf-animation",
                   fmt::format("{} animates weights of a node without morph targets", name));
    }
    channel.width = static_cast<int>(targets);
  } else {
    warn(scene_.diagnostics, "gltf-animation-path",
         fmt::format("{} animates '{}', which is not supported and is ignored", name,
                     from.target_path.substr(0, 40)));
    return {};
  }
  if (auto read = read_keys(source.samplers[static_cast<std::size_t>(from.sampler)], name, channel);
      !read) {
    return read;
  }
  if (node.has_matrix && channel.path != Path::weights) {
    warn(scene_.diagnostics, "gltf-animation-matrix",
         fmt::format("{} animates a node with a matrix; the matrix is decomposed", name));
  }
  if (channel.path == Path::weights) {
    for (const int instance : node.instances) {
      channel.node = instance;
      animation.channels.push_back(channel);
    }
    if (!node.instances.empty()) return {};
  }
  animation.channels.push_back(std::move(channel));
  return {};
}

Result<bool> Reader::read_lens(const tinygltf::Animation& source, const PointerChannel& pointer,
                               Animation& animation) {
  if (!exists(pointer.camera, scene_.cameras.size()) ||
      !exists(pointer.sampler, source.samplers.size())) {
    return false;
  }
  Channel channel;
  channel.node = pointer.camera;
  channel.path = Path::field_of_view;
  channel.width = 1;
  const std::string name =
      fmt::format("{}, {}", label("animation", pointer.animation, source.name), pointer.pointer);
  const auto& sampler = source.samplers[static_cast<std::size_t>(pointer.sampler)];
  if (auto read = read_keys(sampler, name, channel); !read) return read.error();
  const std::size_t parts = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
  for (std::size_t i = parts / 2; i < channel.values->size(); i += parts) {
    const float angle = (*channel.values)[i];
    if (!(angle > 0 && angle < static_cast<float>(kPi))) return false;
  }
  animation.lenses.push_back(std::move(channel));
  return true;
}

Status Reader::read_keys(const tinygltf::AnimationSampler& sampler, const std::string& name,
                         Channel& channel) {
  if (sampler.interpolation == "STEP") {
    channel.interpolation = Interpolation::step;
  } else if (sampler.interpolation == "CUBICSPLINE") {
    channel.interpolation = Interpolation::cubic_spline;
  } else if (!sampler.interpolation.empty() && sampler.interpolation != "LINEAR") {
    return Error("gltf-animation", fmt::format("{} has unknown interpolation '{}'", name,
                                               sampler.interpolation.substr(0, 40)));
  }
  auto times = accessors_.scalars(sampler.input);
  if (!times) return times.error();
  channel.times = std::move(*times);
  const std::vector<float>& keys = *channel.times;
  if (keys.empty()) return Error("gltf-animation", fmt::format("{} has no keys", name));
  std::size_t repeated = 0;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (keys[k] >= 0 && (k == 0 || keys[k] >= keys[k - 1])) {
      repeated += k > 0 && keys[k] == keys[k - 1] ? 1 : 0;
      continue;
    }
    return Error("gltf-animation",
                 fmt::format("{}: the time of key {} is before the previous one", name, k),
                 "key times must be positive and increasing");
  }
  const int components = channel.path == Path::weights ? 1 : channel.width;
  auto values = accessors_.flat(sampler.output, components);
  if (!values) return values.error();
  channel.values = std::move(*values);
  const std::size_t expected = keys.size() * static_cast<std::size_t>(channel.width) *
                               (channel.interpolation == Interpolation::cubic_spline ? 3 : 1);
  if (channel.values->size() != expected) {
    return Error("gltf-animation", fmt::format("{} has {} numbers for {} keys, expected {}", name,
                                               channel.values->size(), keys.size(), expected));
  }
  if (repeated > 0) keep_last_of_each_time(sampler, channel, repeated);
  return {};
}

// Some exporters write the last key of a segment and the first of the next at one time, which the
// specification forbids. Channels that share accessors share what is left of them.
void Reader::keep_last_of_each_time(const tinygltf::AnimationSampler& sampler, Channel& channel,
                                    std::size_t repeated) {
  const std::vector<float>& keys = *channel.times;
  const auto is_last = [&](std::size_t k) { return k + 1 == keys.size() || keys[k + 1] > keys[k]; };
  Shared<float>& times = times_[sampler.input];
  if (times == nullptr) {
    std::vector<float> kept;
    for (std::size_t k = 0; k < keys.size(); ++k) {
      if (is_last(k)) kept.push_back(keys[k]);
    }
    times = std::make_shared<const std::vector<float>>(std::move(kept));
    repeated_ += repeated;
  }
  Shared<float>& values = values_[{sampler.input, sampler.output}];
  if (values == nullptr) {
    const std::size_t each = channel.values->size() / keys.size();
    std::vector<float> kept;
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const auto first = channel.values->begin() + static_cast<std::ptrdiff_t>(k * each);
      if (is_last(k)) kept.insert(kept.end(), first, first + static_cast<std::ptrdiff_t>(each));
    }
    values = std::make_shared<const std::vector<float>>(std::move(kept));
  }
  channel.times = times;
  channel.values = values;
}

void Reader::report_repeated() {
  if (repeated_ == 0) return;
  warn(scene_.diagnostics, "gltf-animation-times",
       fmt::format("{} of animations at the time of the key before: the later ones are kept",
                   counted(static_cast<long long>(repeated_), "key")));
}

}  // namespace

Status read_animations(const ParsedJson& parsed, Accessors& accessors, Scene& scene) {
  const tinygltf::Model& model = parsed.model;
  Reader reader(accessors, scene);
  for (std::size_t i = 0; i < model.animations.size(); ++i) {
    Animation& animation = scene.animations.emplace_back();
    animation.name = model.animations[i].name;
    animation.from_zero = true;
    if (i < parsed.rates.size()) animation.rate = parsed.rates[i];
    for (std::size_t c = 0; c < model.animations[i].channels.size(); ++c) {
      if (auto read = reader.read_channel(model.animations[i], i, c, animation); !read) return read;
    }
  }
  std::vector<std::string> left_out;
  for (const PointerChannel& pointer : parsed.pointers) {
    if (pointer.animation >= model.animations.size()) continue;
    const auto read = reader.read_lens(model.animations[pointer.animation], pointer,
                                       scene.animations[pointer.animation]);
    if (!read) return read.error();
    if (!*read) left_out.push_back(shown(pointer.pointer));
  }
  if (!left_out.empty()) {
    constexpr std::size_t kMaxListed = 6;
    const auto count = std::ssize(left_out);
    if (left_out.size() > kMaxListed) {
      left_out.resize(kMaxListed);
      left_out.emplace_back("...");
    }
    warn(scene.diagnostics, "gltf-animation-pointer",
         fmt::format("{} left out: {}",
                     counted(count, "animated property is", "animated properties are"),
                     fmt::join(left_out, ", ")));
  }
  reader.report_repeated();
  return {};
}

}  // namespace krok::gltf
