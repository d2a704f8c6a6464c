#include <algorithm>
#include <array>
#include <unordered_map>

#include "skin/binding_internal.h"

namespace krok {

namespace skin_detail {

namespace {

// The influences of one vertex with non-zero weight.
struct VertexInfluences {
  std::array<std::uint16_t, Model::kMaxInfluences> joints;
  std::array<float, Model::kMaxInfluences> weights;
  std::size_t count = 0;
};

VertexInfluences influences_of(const Model& model, std::size_t v, SkinMethod method) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  const std::uint16_t* joints = &model.influence_joints[v * places];
  const float* weights = &model.influence_weights[v * places];
  VertexInfluences result;
  for (std::size_t k = 0; k < places; ++k) {
    if (!(weights[k] > 0)) continue;
    result.joints[result.count] = joints[k];
    result.weights[result.count] = weights[k];
    ++result.count;
  }
  if (result.count == 0) {
    result.joints[0] = joints[0];
  } else if (method == SkinMethod::rigid) {
    const auto end = result.weights.begin() + static_cast<std::ptrdiff_t>(result.count);
    const auto strongest = std::max_element(result.weights.begin(), end);
    result.joints[0] = result.joints[static_cast<std::size_t>(strongest - result.weights.begin())];
  }
  if (result.count == 0 || method == SkinMethod::rigid) {
    result.weights[0] = 1.0f;
    result.count = 1;
  }
  return result;
}

// Numbers pairs in order of first use.
class PairNumbers {
 public:
  explicit PairNumbers(std::vector<Pair>& pairs) : pairs_(pairs) {}

  std::uint32_t number(std::uint16_t first, std::uint16_t joint) {
    const std::uint32_t key = std::uint32_t{first} << 16 | joint;
    const auto [found, is_new] = numbers_.emplace(key, static_cast<std::uint32_t>(pairs_.size()));
    if (is_new) pairs_.push_back({first, joint});
    return found->second;
  }

 private:
  std::vector<Pair>& pairs_;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;
};

std::unique_ptr<const Binding> bind(const Model& model, SkinMethod method) {
  auto binding = std::make_unique<Binding>();
  binding->method = method;
  binding->vertex_count = model.positions.size();
  binding->joint_to_world = model.skeleton.reference;
  binding->reference_to_joint = inverse_reference(model.skeleton);
  PairNumbers numbers(binding->pairs);
  std::array<VertexInfluences, kBlock> block;
  for (std::size_t begin = 0; begin < binding->vertex_count; begin += kBlock) {
    const std::size_t size = std::min(kBlock, binding->vertex_count - begin);
    std::size_t most = 0;
    for (std::size_t i = 0; i < size; ++i) {
      block[i] = influences_of(model, begin + i, method);
      most = std::max(most, block[i].count);
    }
    binding->blocks.push_back({binding->joints.size(), most});
    for (std::size_t i = 0; i < size; ++i) {
      const VertexInfluences& vertex = block[i];
      for (std::size_t k = 0; k < most; ++k) {
        // Padding repeats the first joint with weight 0, which does not change the result.
        const std::uint16_t joint = vertex.joints[k < vertex.count ? k : 0];
        binding->joints.push_back(joint);
        binding->weights.push_back(k < vertex.count ? vertex.weights[k] : 0.0f);
        if (method == SkinMethod::dual_quaternion) {
          binding->pair_indices.push_back(numbers.number(vertex.joints[0], joint));
        }
      }
    }
  }
  return binding;
}

}  // namespace

Influences Binding::influences() const {
  Influences result;
  result.joints = joints.data();
  result.pairs = pair_indices.empty() ? nullptr : pair_indices.data();
  result.weights = weights.data();
  result.blocks = blocks.data();
  return result;
}

}  // namespace skin_detail

SkinBinding::SkinBinding(const Model& model, SkinMethod method)
    : data_(skin_detail::bind(model, method)) {}
SkinBinding::SkinBinding(SkinBinding&&) noexcept = default;
SkinBinding& SkinBinding::operator=(SkinBinding&&) noexcept = default;
SkinBinding::~SkinBinding() = default;

SkinMethod SkinBinding::method() const {
  return data_->method;
}
std::size_t SkinBinding::vertex_count() const {
  return data_->vertex_count;
}
std::size_t SkinBinding::joint_count() const {
  return data_->reference_to_joint.size();
}

}  // namespace krok
