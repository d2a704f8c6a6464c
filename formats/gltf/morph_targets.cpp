#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/gltf/joint_tracks.h"
#include "formats/gltf/morph_targets_internal.h"
#include "formats/gltf/quantize_internal.h"

namespace krok::gltf {

namespace {

Status check_weights(const MorphWeights& weights, const MorphSet* morphs) {
  if (morphs == nullptr || weights.names != morphs->names) {
    return Error("gltf-morphs", "the weights do not match the model's morph targets");
  }
  if (weights.names.empty()) return {};
  const auto finite = [](float weight) { return std::isfinite(weight); };
  if (weights.values.size() % weights.names.size() == 0 &&
      std::ranges::all_of(weights.values, finite)) {
    return {};
  }
  return Error("gltf-morphs", "a morph weight is missing or not finite");
}

std::vector<Vec3f> displacements(std::span<const Vec3f> target, std::span<const Vec3f> base) {
  std::vector<Vec3f> moved(base.size());
  std::transform(target.begin(), target.end(), base.begin(), moved.begin(),
                 [](const Vec3f& to, const Vec3f& from) -> Vec3f { return to - from; });
  return moved;
}

}  // namespace

Status check_morphs(const Model& model, const WriteOptions& options) {
  if (options.weights != nullptr) {
    if (Status status = check_weights(*options.weights, options.morphs); !status) return status;
  }
  if (options.morphs == nullptr) return {};
  if (Status status = check(*options.morphs); !status) return status;
  if (options.morphs->vertex_count == model.vertex_count()) return {};
  return Error("gltf-morphs", fmt::format("the morph targets have {} vertices, the model has {}",
                                          options.morphs->vertex_count, model.vertex_count()));
}

Status add_morphs(Document& document, const Model& model,
                  const std::map<std::string, int>& attributes,
                  std::span<const Document::MeshNode> meshes, const WriteOptions& options) {
  if (options.morphs == nullptr || options.morphs->names.empty()) return {};
  const MorphSet& morphs = *options.morphs;
  std::vector<std::map<std::string, int>> targets(morphs.names.size());
  for (int t = 0; t < morphs.target_count(); ++t) {
    auto& target = targets[static_cast<std::size_t>(t)];
    if (options.quantized) {
      target = add_quantized_target(document, model, morphs, t,
                                    PositionGrid::of(model.positions, *options.quantized));
      continue;
    }
    target["POSITION"] =
        document.add_positions(displacements(morphs.target_positions(t), model.positions));
    // In glTF a target may only have attributes that the mesh has.
    if (morphs.normals.empty() || model.normals.empty() || !attributes.contains("NORMAL")) continue;
    target["NORMAL"] = document.add_vectors(displacements(morphs.target_normals(t), model.normals));
  }
  document.set_targets(meshes, targets, morphs.names);
  if (options.weights == nullptr) return {};
  const MorphWeights& weights = *options.weights;
  if (weights.frame_count() == 1) {
    for (const Document::MeshNode& made : meshes) {
      document.gltf.meshes[static_cast<std::size_t>(made.mesh)].weights.assign(
          weights.values.begin(), weights.values.end());
    }
  } else if (weights.frame_count() > 1) {
    const auto times = key_times(weights.frame_count(), weights.rate);
    if (!times) return times.error();
    document.add_weight_keys(meshes, *times, weights.values,
                             options.clip_name.empty() ? options.name : options.clip_name);
  }
  return {};
}

void Document::add_weight_keys(std::span<const MeshNode> meshes, std::span<const float> times,
                               std::span<const float> weights, const std::string& name) {
  const int input = add_floats(times, TINYGLTF_TYPE_SCALAR, Use::data, true);
  const int output = add_floats(weights, TINYGLTF_TYPE_SCALAR, Use::data, false);
  add_weight_channels(meshes, input, output, name);
}

void Document::add_weight_channels(std::span<const MeshNode> meshes, int times, int weights,
                                   const std::string& name) {
  if (gltf.animations.empty()) gltf.animations.emplace_back().name = name;
  for (const MeshNode& made : meshes) {
    add_channel(gltf.animations.front(), made.node, "weights", times, weights);
  }
}

}  // namespace krok::gltf
