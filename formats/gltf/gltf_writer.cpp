#include "formats/gltf/gltf_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "formats/gltf/document_internal.h"
#include "scene/influences.h"

namespace krok::gltf {

namespace {

using Use = Document::Use;

// glTF wants normals of length 1 whatever the model has.
Vec3f unit_or_up(const Vec3f& vector) {
  const Vec3 direction = vector.cast<double>();
  const double length = direction.norm();
  if (!(length > 1e-15) || !std::isfinite(length)) return Vec3f::UnitY();
  return (direction / length).cast<float>();
}

std::vector<Vec3f> unit_vectors(std::span<const Vec3f> vectors) {
  std::vector<Vec3f> result(vectors.size());
  std::transform(vectors.begin(), vectors.end(), result.begin(), unit_or_up);
  return result;
}

std::vector<Vec4f> unit_tangents(std::span<const Vec4f> tangents) {
  std::vector<Vec4f> result;
  for (const Vec4f& tangent : tangents) {
    const Vec3f direction = unit_or_up(tangent.head<3>());
    result.emplace_back(direction.x(), direction.y(), direction.z(), tangent.w() < 0 ? -1.f : 1.f);
  }
  return result;
}

// The attributes that every mesh has.
std::map<std::string, int> add_shape(Document& document, const Model& model,
                                     const MeshShape& shape) {
  std::map<std::string, int> attributes;
  attributes["POSITION"] = document.add_positions(shape.positions);
  if (!shape.normals.empty()) {
    attributes["NORMAL"] = document.add_vectors(unit_vectors(shape.normals));
  }
  if (!shape.tangents.empty()) {
    const auto tangents = unit_tangents(shape.tangents);
    attributes["TANGENT"] = document.add_floats({tangents.data()->data(), tangents.size() * 4},
                                                TINYGLTF_TYPE_VEC4, Use::vertices, false);
  }
  if (!model.texture_coordinates.empty()) {
    attributes["TEXCOORD_0"] = document.add_floats(
        {model.texture_coordinates.data()->data(), model.texture_coordinates.size() * 2},
        TINYGLTF_TYPE_VEC2, Use::vertices, false);
  }
  return attributes;
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

Status check_mesh(const Model& model) {
  if (Status sound = check(model); !sound) return sound;
  if (model.positions.empty() || model.triangles.empty()) {
    return Error("gltf-empty-mesh", "the model has no triangles, and glTF knows no empty mesh");
  }
  return {};
}

// The default name of a mesh's node must not collide with a joint's, which keeps its own.
std::string mesh_name(const WriteOptions& options) {
  return options.name + "_mesh";
}

}  // namespace

Status write_skeleton(const Clip& clip, const WriteOptions& options, OutputFile& file) {
  if (Status sound = check(clip); !sound) return sound;
  const auto tracks = joint_tracks(clip.skeleton, clip);
  if (!tracks) return tracks.error();
  return write_skeleton(clip.skeleton, *tracks, options, file);
}

Status write_skeleton(const Skeleton& skeleton, const JointTracks& tracks,
                      const WriteOptions& options, OutputFile& file) {
  if (Status sound = check(skeleton); !sound) return sound;
  if (skeleton.empty()) return Error("gltf-structure", "the motion has no joints");
  assert(tracks.joints.size() == skeleton.names.size());
  Document document(options);
  document.add_skeleton(skeleton, tracks, options.name);
  return document.write(file);
}

Status write_rig(const Model& model, const Clip& clip, const WriteOptions& options,
                 OutputFile& file) {
  if (Status sound = check(clip); !sound) return sound;
  if (Status sound = check_mesh(model); !sound) return sound;
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
  if (Status sound = check_mesh(model); !sound) return sound;
  assert(tracks.joints.size() == model.skeleton.names.size());
  Document document(options);
  const int skin = document.add_skeleton(model.skeleton, tracks, options.name);
  auto attributes = add_shape(document, model, {model.positions, model.normals, model.tangents});
  add_influences(document, model, attributes);
  const auto mesh = document.add_mesh(model, attributes, mesh_name(options));
  if (!mesh) return mesh.error();
  document.add_mesh_node(*mesh, skin, mesh_name(options));
  return document.write(file);
}

Status write_mesh(const Model& model, const MeshShape& shape, const WriteOptions& options,
                  OutputFile& file) {
  if (Status sound = check_mesh(model); !sound) return sound;
  Document document(options);
  const auto mesh = document.add_mesh(model, add_shape(document, model, shape), mesh_name(options));
  if (!mesh) return mesh.error();
  document.add_mesh_node(*mesh, -1, mesh_name(options));
  return document.write(file);
}

std::uint64_t baked_bytes(const Model& model, std::int64_t frames) {
  const std::uint64_t vertex = model.normals.empty() ? 12 : 24;
  const auto count = static_cast<std::uint64_t>(std::max<std::int64_t>(frames, 1));
  return count * model.positions.size() * vertex + count * (count - 1) * sizeof(float);
}

Status write_baked(const Model& model, const BakedMotion& motion, const WriteOptions& options,
                   OutputFile& file, Progress* progress) {
  if (Status sound = check_mesh(model); !sound) return sound;
  if (motion.frames < 1) return Error("gltf-structure", "the motion has no frames to bake");
  const auto times = key_times(motion.frames, motion.rate);
  if (!times) return times.error();

  const std::size_t vertices = model.positions.size();
  std::vector<Vec3f> base_positions(vertices), positions(vertices);
  std::vector<Vec3f> base_normals(model.normals.size()), normals(model.normals.size());
  motion.shape_at(0, base_positions, base_normals);

  Document document(options);
  const auto attributes = add_shape(document, model, {base_positions, base_normals, {}});
  const auto mesh = document.add_mesh(model, attributes, mesh_name(options));
  if (!mesh) return mesh.error();
  const int node = document.add_mesh_node(*mesh, -1, mesh_name(options));

  const int targets = motion.frames - 1;
  document.reserve(static_cast<std::size_t>(baked_bytes(model, targets + 1)));
  std::vector<std::map<std::string, int>> morph(static_cast<std::size_t>(targets));
  if (progress != nullptr) progress->begin("baking frames", static_cast<std::uint64_t>(targets));
  for (int t = 0; t < targets; ++t) {
    motion.shape_at(t + 1, positions, normals);
    for (std::size_t v = 0; v < vertices; ++v) positions[v] -= base_positions[v];
    for (std::size_t v = 0; v < normals.size(); ++v) normals[v] -= base_normals[v];
    auto& target = morph[static_cast<std::size_t>(t)];
    target["POSITION"] = document.add_positions(positions);
    if (!normals.empty()) target["NORMAL"] = document.add_vectors(normals);
    if (progress != nullptr) progress->advance(1);
  }
  if (targets > 0) document.add_morph_motion(*mesh, node, morph, *times, options.name);
  return document.write(file);
}

}  // namespace krok::gltf
