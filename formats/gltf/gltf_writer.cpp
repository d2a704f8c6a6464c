#include "formats/gltf/gltf_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/index.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/quantize_internal.h"
#include "formats/gltf/reduce_for_mesh.h"
#include "nodes/evaluate.h"

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

// Whether the options' targets and weights, if any, match the model. Codes: gltf-morphs and those
// of check(MorphSet).
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

// The clip's name, as the options give it.
const std::string& clip_name(const WriteOptions& options) {
  return options.clip_name.empty() ? options.name : options.clip_name;
}

Status add_weight_keys(Document& document, std::span<const Document::MeshNode> meshes,
                       const MorphWeights& weights, const std::string& name,
                       std::size_t animation = 0) {
  if (weights.frame_count() < 2) return {};
  const auto times = key_times(weights.frame_count(), weights.rate);
  if (!times) return times.error();
  document.add_weight_keys(meshes, weights, *times, name, animation);
  return {};
}

// Whether a target has other normals than the mesh.
bool turns_normals(const MorphSet& morphs, const Model& model) {
  if (morphs.normals.empty() || model.normals.empty()) return false;
  for (int t = 0; t < morphs.target_count(); ++t) {
    if (!std::ranges::equal(morphs.target_normals(t), model.normals)) return true;
  }
  return false;
}

// Adds them to the model's meshes that they move, which have `attributes`, and to the animations of
// their nodes.
Status add_morphs(Document& document, const Model& model,
                  const std::map<std::string, int>& attributes,
                  std::span<const Document::MeshNode> all_meshes,
                  std::span<const NamedTracks> clips, const WriteOptions& options) {
  if (options.morphs == nullptr || options.morphs->names.empty()) return {};
  const MorphSet& morphs = *options.morphs;
  const bool has_normals = attributes.contains("NORMAL") && turns_normals(morphs, model);
  const auto meshes = document.moved_meshes(all_meshes, [&](std::size_t v) {
    for (int t = 0; t < morphs.target_count(); ++t) {
      if (morphs.target_positions(t)[v] != model.positions[v]) return true;
      if (has_normals && morphs.target_normals(t)[v] != model.normals[v]) return true;
    }
    return false;
  });
  std::vector<std::map<std::string, int>> targets(morphs.names.size());
  for (int t = 0; t < morphs.target_count(); ++t) {
    auto& target = targets[static_cast<std::size_t>(t)];
    if (options.quantized) {
      target =
          add_quantized_target(document, model, morphs, t,
                               PositionGrid::of(model.positions, *options.quantized), has_normals);
      continue;
    }
    target["POSITION"] = document.add_displacements(
        displacements(morphs.target_positions(t), model.positions), true);
    // In glTF a target may only have attributes that the mesh has.
    if (!has_normals) continue;
    target["NORMAL"] =
        document.add_displacements(displacements(morphs.target_normals(t), model.normals), false);
  }
  document.set_targets(meshes, targets, morphs.names);
  if (options.weights != nullptr && options.weights->frame_count() > 0) {
    const std::size_t count = morphs.names.size();
    const bool still = options.weights->frame_count() == 1;
    for (const Document::MeshNode& made : meshes) {
      std::vector<double>& rest = document.gltf.meshes[static_cast<std::size_t>(made.mesh)].weights;
      if (still) {
        rest.assign(options.weights->values.begin(),
                    options.weights->values.begin() + static_cast<std::ptrdiff_t>(count));
      }
    }
  }
  if (clips.empty() && options.weights != nullptr) {
    return add_weight_keys(document, meshes, *options.weights, clip_name(options));
  }
  std::size_t animation = 0;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const MorphWeights* weights = clips[i].weights;
    if (weights == nullptr && i == 0) weights = options.weights;
    const auto& times = clips[i].tracks->times;
    if (weights != nullptr && (!times.empty() || clips.size() == 1)) {
      Status status = add_weight_keys(document, meshes, *weights, clips[i].name, animation);
      if (!status) return status;
    }
    animation += times.empty() ? 0 : 1;
  }
  return {};
}

using Use = Document::Use;

// Of vertices on one joint each as bytes, which are exact and a quarter of the size.
int add_weights(Document& document, std::span<const float> weights) {
  if (!std::ranges::all_of(weights, [](float weight) { return weight == 0 || weight == 1; })) {
    return document.add_floats(weights, TINYGLTF_TYPE_VEC4, Use::vertices, false);
  }
  std::vector<std::uint8_t> bytes;
  for (const float weight : weights) bytes.push_back(weight == 0 ? 0 : 255);
  return document.add_strided(std::as_bytes(std::span(bytes)), 4,
                              TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_VEC4, true);
}

// JOINTS_0, WEIGHTS_0 and, for more than four influences, JOINTS_1, WEIGHTS_1.
void add_influences(Document& document, const Model& model,
                    std::map<std::string, int>& attributes) {
  Model bound;  // only what normalize_influences reads
  bound.positions = model.positions;
  bound.influences_per_vertex = model.influences_per_vertex;
  bound.influence_joints = model.influence_joints;
  bound.influence_weights = model.influence_weights;
  normalize_influences(bound);
  limit_influences(bound, used_influences(bound));

  const auto count = static_cast<std::size_t>(bound.vertex_count());
  const int places = bound.influences_per_vertex;
  const auto largest = static_cast<std::uint32_t>(model.skeleton.joint_count() - 1);
  for (int set = 0; set * 4 < places; ++set) {
    std::vector<std::uint32_t> joints(count * 4, 0);
    std::vector<float> weights(count * 4, 0.0f);
    const int used = std::min(4, places - set * 4);
    for (std::size_t v = 0; v < count; ++v) {
      const std::size_t from =
          v * static_cast<std::size_t>(places) + static_cast<std::size_t>(set) * 4;
      std::copy_n(&bound.influence_joints[from], used, &joints[v * 4]);
      std::copy_n(&bound.influence_weights[from], used, &weights[v * 4]);
    }
    attributes[fmt::format("JOINTS_{}", set)] =
        document.add_integers(joints, TINYGLTF_TYPE_VEC4, largest, Use::vertices);
    attributes[fmt::format("WEIGHTS_{}", set)] = add_weights(document, weights);
  }
}

}  // namespace

Status write_skeleton(const Clip& clip, const WriteOptions& options, OutputFile& file) {
  if (Status status = check(clip); !status) return status;
  const auto tracks = joint_tracks(clip.skeleton, clip);
  if (!tracks) return tracks.error();
  return write_skeleton(clip.skeleton, *tracks, options, file);
}

Status write_skeleton(const Skeleton& skeleton, const JointTracks& tracks,
                      const WriteOptions& options, OutputFile& file) {
  const NamedTracks clip{clip_name(options), &tracks};
  return write_skeleton(skeleton, std::span(&clip, 1), options, file);
}

Status write_skeleton(const Skeleton& skeleton, std::span<const NamedTracks> clips,
                      const WriteOptions& options, OutputFile& file) {
  if (Status status = check(skeleton); !status) return status;
  if (skeleton.empty()) return Error("gltf-structure", "the motion has no joints");
  Document document(options);
  document.add_skeleton(skeleton, clips, options.name);
  return document.write(file);
}

Status write_rig(const Model& model, const Clip& clip, const WriteOptions& options,
                 OutputFile& file) {
  if (Status status = check(clip); !status) return status;
  if (Status status = check_mesh(model); !status) return status;
  const std::string difference = difference_in_structure(model.skeleton, clip.skeleton);
  if (!difference.empty()) {
    return Error("gltf-structure", "model and motion have different skeletons: " + difference);
  }
  const auto tracks = joint_tracks(model.skeleton, clip);
  if (!tracks) return tracks.error();
  return write_rig(model, *tracks, options, file);
}

Status write_rig(const Model& model, const JointTracks& tracks, const WriteOptions& options,
                 OutputFile& file) {
  const NamedTracks clip{clip_name(options), &tracks};
  return write_rig(model, std::span(&clip, 1), options, file);
}

Status write_rig(const Model& model, std::span<const NamedTracks> clips,
                 const WriteOptions& options, OutputFile& file) {
  if (Status status = check_mesh(model); !status) return status;
  if (Status status = check_morphs(model, options); !status) return status;
  for (const NamedTracks& clip : clips) {
    if (clip.weights == nullptr) continue;
    if (Status status = check_weights(*clip.weights, options.morphs); !status) return status;
  }
  Document document(options);
  const PositionGrid grid =
      options.quantized ? PositionGrid::of(model.positions, *options.quantized) : PositionGrid();
  const int skin = document.add_skeleton(model.skeleton, clips, options.name, grid.to_model());
  if (Status status = document.add_eyes(model.skeleton, skin, options.eyes); !status) return status;
  if (Status status = document.add_sockets(model.skeleton, skin, options.sockets); !status) {
    return status;
  }
  std::map<std::string, int> attributes;
  if (options.quantized) {
    Model stored = model;
    normalize_influences(stored);
    limit_influences(stored, used_influences(stored));
    attributes = add_quantized_shape(document, stored, grid, *options.quantized);
    document.gltf.extensionsUsed.emplace_back("KHR_mesh_quantization");
    document.gltf.extensionsRequired.emplace_back("KHR_mesh_quantization");
  } else {
    attributes = add_shape(document, model, {model.positions, model.normals, model.tangents});
    add_influences(document, model, attributes);
  }
  const auto meshes = document.add_meshes(model, attributes, skin, mesh_name(options), true);
  if (!meshes) return meshes.error();
  Status status = add_morphs(document, model, attributes, *meshes, clips, options);
  if (status) status = document.add_attached(skin, options.attached);
  return status ? document.write(file) : status;
}

Status write_mesh(const Model& model, const MeshShape& shape, const WriteOptions& options,
                  OutputFile& file) {
  if (Status status = check_mesh(model); !status) return status;
  if (Status status = check_morphs(model, options); !status) return status;
  Document document(options);
  const auto attributes = add_shape(document, model, shape);
  const auto meshes = document.add_meshes(model, attributes, -1, mesh_name(options), true);
  if (!meshes) return meshes.error();
  Status status = add_morphs(document, model, attributes, *meshes, {}, options);
  return status ? document.write(file) : status;
}

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Where the file has a vertex.
struct Link {
  std::uint32_t instance = kNone, vertex = 0;
};

// [vertices of the original]. Primitives have a range of the model's vertices, or all of them.
Result<std::vector<Link>> links_of(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                   const OriginalRig& original, const WrittenRig& written) {
  std::vector<Link> links(written.model.positions.size());
  std::uint32_t instance = 0;
  const Error other("gltf-mesh", "the written file does not have the triangles of the rig");
  for (const Model::Part& part : written.model.parts) {
    if (part.triangle_count == 0) continue;
    while (instance < evaluator.instances().size() &&  // what joints carry
           scene.nodes[at(evaluator.instances()[instance].node)].skin < 0) {
      ++instance;
    }
    if (instance == evaluator.instances().size()) return other;
    const nodes::Primitive& shape = evaluator.primitive(evaluator.instances()[instance]);
    if (shape.triangles.size() != part.triangle_count) return other;
    std::uint32_t first = kNone, first_there = kNone;
    const auto triangles =
        std::span(written.model.triangles).subspan(part.first_triangle, part.triangle_count);
    for (const auto& triangle : triangles) first = std::min(first, std::ranges::min(triangle));
    for (const auto& triangle : shape.triangles) {
      first_there = std::min(first_there, std::ranges::min(triangle));
    }
    for (const auto& triangle : triangles) {
      for (const std::uint32_t corner : triangle) {
        const std::uint32_t there = corner - first + first_there;
        if (there >= shape.vertex_count()) return other;
        if (links[corner].instance == kNone) links[corner] = {instance, there};
      }
    }
    ++instance;
  }
  if (written.places.empty()) return links;
  std::vector<Link> result(original.model.positions.size());
  for (std::size_t v = 0; v < result.size(); ++v) result[v] = links[written.places[v]];
  return result;
}

}  // namespace

Result<WrittenError> written_error(const std::string& path, const OriginalRig& original,
                                   const WrittenRig& written, int jobs) {
  const auto scene = read_file(path);
  if (!scene) return scene.error();
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return evaluator.error();
  const auto links = links_of(*scene, *evaluator, original, written);
  if (!links) return links.error();
  WrittenError worst;
  std::size_t next = 0;
  for (std::size_t i = 0; i < original.clips.size(); ++i) {
    const NamedTracks& clip = original.clips[i];
    // Clips in which nothing changes are not in the file.
    const bool is_there =
        next < scene->animations.size() && scene->animations[next].name == clip.name;
    const int animation = is_there ? static_cast<int>(next++) : -1;
    const double rate = clip.tracks->times.empty() && clip.weights != nullptr ? clip.weights->rate
                                                                              : clip.tracks->rate;
    const ShownMesh in_file = [&, animation, rate] {
      return [&, animation, rate, shown = std::make_shared<nodes::Evaluation>()](
                 int moment, std::span<Vec3f> positions) {
        evaluator->evaluate(animation, 0.5 * moment / rate, *shown);
        for (std::size_t v = 0; v < positions.size(); ++v) {
          const Link& link = (*links)[v];
          if (link.instance == kNone) {
            positions[v].setConstant(std::numeric_limits<float>::quiet_NaN());
          } else {
            positions[v] = shown->positions[link.instance][link.vertex].cast<float>();
          }
        }
      };
    };
    const bool changes_shape = clip.weights != nullptr && original.morphs.target_count() > 0;
    const MeshError error = mesh_error({original.model, changes_shape ? &original.morphs : nullptr,
                                        changes_shape ? clip.weights : nullptr},
                                       *clip.tracks, in_file, jobs);
    if (i == 0 || error.largest > worst.error.largest) worst = {error, i};
  }
  return worst;
}

}  // namespace krok::gltf
