#include "formats/gltf/gltf_writer.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/gltf/document_internal.h"
#include "formats/gltf/mesh_shape_internal.h"
#include "formats/gltf/morph_targets_internal.h"
#include "formats/gltf/quantize_internal.h"
#include "scene/influences.h"
#include "scene/tangents.h"

namespace krok::gltf {

namespace {

using Use = Document::Use;

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
    attributes[fmt::format("WEIGHTS_{}", set)] =
        document.add_floats(weights, TINYGLTF_TYPE_VEC4, Use::vertices, false);
  }
}

// The clip's name, as the options give it.
const std::string& clip_name(const WriteOptions& options) {
  return options.clip_name.empty() ? options.name : options.clip_name;
}

// Tangents, if a normal texture needs them and the shape has none.
std::vector<Vec4f> missing_tangents(const Model& model, const MeshShape& shape,
                                    const WriteOptions& options) {
  if (!shape.tangents.empty() || shape.normals.empty() ||
      !needs_tangents(model, options.materials)) {
    return {};
  }
  return make_tangents(shape.positions, shape.normals, model.texture_coordinates, model.triangles);
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
  Document document(options);
  const PositionGrid grid =
      options.quantized ? PositionGrid::of(model.positions, *options.quantized) : PositionGrid();
  const int skin = document.add_skeleton(model.skeleton, clips, options.name, grid.to_model());
  if (Status status = document.add_eyes(model.skeleton, skin, options.eyes); !status) return status;
  MeshShape shape{model.positions, model.normals, model.tangents};
  const std::vector<Vec4f> tangents = missing_tangents(model, shape, options);
  if (!tangents.empty()) shape.tangents = tangents;
  std::map<std::string, int> attributes;
  if (options.quantized) {
    Model stored = model;
    if (!tangents.empty()) stored.tangents = tangents;
    normalize_influences(stored);
    limit_influences(stored, used_influences(stored));
    attributes = add_quantized_shape(document, stored, grid, *options.quantized);
    document.gltf.extensionsUsed.emplace_back("KHR_mesh_quantization");
    document.gltf.extensionsRequired.emplace_back("KHR_mesh_quantization");
  } else {
    attributes = add_shape(document, model, shape);
    add_influences(document, model, attributes);
  }
  const auto meshes = document.add_meshes(model, attributes, skin, mesh_name(options), true);
  if (!meshes) return meshes.error();
  Status status = add_morphs(document, model, attributes, *meshes, options);
  return status ? document.write(file) : status;
}

Status write_mesh(const Model& model, const MeshShape& given, const WriteOptions& options,
                  OutputFile& file) {
  if (Status status = check_mesh(model); !status) return status;
  if (Status status = check_morphs(model, options); !status) return status;
  Document document(options);
  MeshShape shape = given;
  const std::vector<Vec4f> tangents = missing_tangents(model, shape, options);
  if (!tangents.empty()) shape.tangents = tangents;
  const auto attributes = add_shape(document, model, shape);
  const auto meshes = document.add_meshes(model, attributes, -1, mesh_name(options), true);
  if (!meshes) return meshes.error();
  Status status = add_morphs(document, model, attributes, *meshes, options);
  return status ? document.write(file) : status;
}

}  // namespace krok::gltf
