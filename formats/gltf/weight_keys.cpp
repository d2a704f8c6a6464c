#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/reduce_for_mesh.h"

// Keys of morph weights: frames between which weights are straight lines.

namespace krok::gltf {

namespace {

// What floats lose on a line, and what leaves a vertex where it is.
constexpr float kSameWeight = 1e-6f;

// The slopes of lines from a key that pass all weights of a target since then.
struct Slopes {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

// The largest whole number of so many bits that weights of this sign are shares of.
double steps_of(int bits, bool is_signed) {
  return std::exp2(bits - (is_signed ? 1 : 0)) - 1;
}

bool is_share(std::span<const float> weights) {
  return std::ranges::all_of(weights, [](float weight) { return std::abs(weight) <= 1; });
}
bool has_negative(std::span<const float> weights) {
  return std::ranges::any_of(weights, [](float weight) { return weight < 0; });
}

template <typename Integer>
std::vector<Integer> whole_numbers(std::span<const float> weights, double steps) {
  std::vector<Integer> numbers;
  for (const float weight : weights) {
    numbers.push_back(static_cast<Integer>(std::lround(static_cast<double>(weight) * steps)));
  }
  return numbers;
}

}  // namespace

std::vector<std::size_t> weight_keys(const MorphWeights& weights, std::span<const float> slack) {
  const std::size_t targets = weights.names.size(), frames = at(weights.frame_count());
  const auto value = [&](std::size_t frame, std::size_t target) {
    return static_cast<double>(weights.values[frame * targets + target]);
  };
  std::vector<std::size_t> keys;
  std::vector<Slopes> slopes(targets);
  for (std::size_t key = 0; key < frames;) {
    keys.push_back(key);
    std::ranges::fill(slopes, Slopes());
    std::size_t next = key + 1;
    bool open = true;  // whether a later frame may still be the next key
    for (std::size_t frame = key + 1; open && frame < frames; ++frame) {
      const auto time = static_cast<double>(frame - key);
      bool straight = true;
      for (std::size_t t = 0; t < targets; ++t) {
        const double rise = value(frame, t) - value(key, t);
        const double allowed = static_cast<double>(slack[t]);
        straight = straight && rise >= slopes[t].least * time && rise <= slopes[t].most * time;
        slopes[t].least = std::max(slopes[t].least, (rise - allowed) / time);
        slopes[t].most = std::min(slopes[t].most, (rise + allowed) / time);
        open = open && slopes[t].least <= slopes[t].most;
      }
      if (straight) next = frame;
    }
    key = next;
  }
  return keys;
}

MorphWeights on_keys(const MorphWeights& weights, std::span<const float> slack, int bits) {
  const std::size_t targets = weights.names.size();
  const std::vector<std::size_t> keys = weight_keys(weights, slack);
  MorphWeights kept = weights;
  if (bits < 32 && is_share(weights.values)) {
    const double steps = steps_of(bits, has_negative(weights.values));
    for (float& value : kept.values) {
      value = static_cast<float>(std::round(static_cast<double>(value) * steps) / steps);
    }
  }
  for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
    const std::size_t from = keys[k], to = keys[k + 1];
    for (std::size_t frame = from + 1; frame < to; ++frame) {
      const double share = static_cast<double>(frame - from) / static_cast<double>(to - from);
      for (std::size_t t = 0; t < targets; ++t) {
        kept.values[frame * targets + t] = static_cast<float>(
            std::lerp(static_cast<double>(kept.values[from * targets + t]),
                      static_cast<double>(kept.values[to * targets + t]), share));
      }
    }
  }
  return kept;
}

int Document::add_weights(std::span<const float> weights) {
  const bool is_signed = has_negative(weights);
  const auto add = [&](const auto& numbers, int type) {
    const int index = add_accessor(std::as_bytes(std::span(numbers)), type, sizeof numbers[0],
                                   TINYGLTF_TYPE_SCALAR, Use::data);
    gltf.accessors[at(index)].normalized = true;
    return index;
  };
  for (const int bits : {8, 16}) {
    const double steps = steps_of(bits, is_signed);
    const bool fits = std::ranges::all_of(weights, [&](float weight) {
      const double number = static_cast<double>(weight) * steps;
      return std::abs(number - std::round(number)) < 1e-6 * steps;
    });
    if (!options_.quantized || !is_share(weights) || !fits) continue;
    if (bits == 8) {
      return is_signed
                 ? add(whole_numbers<std::int8_t>(weights, steps), TINYGLTF_COMPONENT_TYPE_BYTE)
                 : add(whole_numbers<std::uint8_t>(weights, steps),
                       TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE);
    }
    return is_signed
               ? add(whole_numbers<std::int16_t>(weights, steps), TINYGLTF_COMPONENT_TYPE_SHORT)
               : add(whole_numbers<std::uint16_t>(weights, steps),
                     TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
  }
  return add_floats(weights, TINYGLTF_TYPE_SCALAR, Use::data, false);
}

void Document::add_weight_keys(std::span<const MeshNode> meshes, const MorphWeights& weights,
                               std::span<const float> times, const std::string& name,
                               std::size_t animation) {
  const std::size_t targets = weights.names.size();
  const std::vector<float> slack(targets, kSameWeight);
  std::vector<float> key_times, values;
  for (const std::size_t frame : weight_keys(weights, slack)) {
    key_times.push_back(times[frame]);
    const auto from = std::span(weights.values).subspan(frame * targets, targets);
    values.insert(values.end(), from.begin(), from.end());
  }
  const auto [place, made] = times_.emplace(key_times, 0);
  if (made) place->second = add_floats(key_times, TINYGLTF_TYPE_SCALAR, Use::data, true);
  const int input = place->second;
  add_weight_channels(meshes, input, add_weights(values), name, animation);
}

void Document::add_weight_channels(std::span<const MeshNode> meshes, int times, int weights,
                                   const std::string& name, std::size_t animation) {
  if (animation >= gltf.animations.size()) gltf.animations.emplace_back().name = name;
  auto& to = gltf.animations[std::min(animation, gltf.animations.size() - 1)];
  for (const MeshNode& made : meshes) add_channel(to, made.node, "weights", times, weights);
}

}  // namespace krok::gltf
