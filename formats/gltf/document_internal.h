#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "formats/gltf/filters_internal.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/joint_tracks.h"
#include "scene/clip.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"

// A glTF file under construction: one buffer, one scene. Private to the writers.

namespace krok::gltf {

class Document {
 public:
  explicit Document(const WriteOptions& options);

  enum class Use { vertices, indices, data };

  // Copy values, or reference them; then they must stay valid and unchanged until write().
  enum class Keep { copy, view };

  // Appends values in a new buffer view and returns the accessor. Values must not be empty.
  // `bounds` writes min and max.
  int add_floats(std::span<const float> values, int type, Use use, bool bounds,
                 Keep keep = Keep::copy);
  int add_positions(std::span<const Vec3f> values, Use use = Use::vertices);  // with bounds
  int add_vectors(std::span<const Vec3f> values, Use use = Use::vertices);
  // Displacements that are mostly none, as sparse accessors where that takes less than half of the
  // bytes: until set_targets() the accessor has no data. Not in compressed files, which are as
  // small without. (part_vertices.cpp)
  int add_displacements(std::vector<Vec3f> values, bool bounds);
  // The same of floats or normalized whole numbers (given as such); -1 if not sparse.
  int add_sparse(std::vector<Vec3f> values, bool bounds, int component);
  int add_integers(std::span<const std::uint32_t> values, int type, std::uint32_t largest, Use use);

  // Vertex values of a fixed number of bytes each, the last of them padding if they are fewer.
  int add_strided(std::span<const std::byte> bytes, std::size_t stride, int component, int type,
                  bool normalized);
  // Values behind a filter, four bytes a vector of directions, eight a quaternion, four a float.
  int add_filtered(std::span<const std::byte> bytes, int type, Filter filter, Use use);

  // `wanted`, with a number appended if another node has that name.
  std::string unique_node_name(const std::string& wanted);

  // Adds nodes for all joints in the reference pose, the first as a scene root; a skin with the
  // inverse bind matrices; an animation for each clip that has times. A joint that shears in any of
  // them gets a node above it. The tracks must outlive write(). Returns the skin.
  // `stored_to_model` transforms the vertices of the mesh, if it is quantized.
  int add_skeleton(const Skeleton& skeleton, std::span<const NamedTracks> clips,
                   const std::string& name, const Mat4& stored_to_model = Mat4::Identity());

  // The material of this name from WriteOptions::materials, or a default one; added once, as are
  // its images. Textures are left out for meshes without texture coordinates (`attributes` are the
  // same in all calls). Codes: those of image_info().
  // (materials.cpp)
  Result<int> add_material(const std::string& name, const std::map<std::string, int>& attributes);

  // Eye nodes as children of the joints from add_skeleton(). Code: gltf-structure.
  Status add_eyes(const Skeleton& skeleton, int skin, std::span<const Character::Eye> eyes);

  // The same for sockets, and meshes below these or below joints. Code: gltf-structure.
  Status add_sockets(const Skeleton& skeleton, int skin,
                     std::span<const Character::Socket> sockets);
  Status add_attached(int skin, std::span<const Attached> attached);

  struct MeshNode {
    int mesh = 0, node = 0;
  };
  // Meshes with a node each at the scene root: one primitive per part of the model, all with the
  // same attributes. Parts in a row of one mesh (Model::Part::mesh) share one; `name` is that of
  // parts without. Skin -1 for none. With `own_vertices`, each primitive gets a range of the
  // vertices, if no two parts share one and the parts follow each other: then loaders do not load
  // all vertices for each part. (part_vertices.cpp)
  Result<std::vector<MeshNode>> add_meshes(const Model& model,
                                           const std::map<std::string, int>& attributes, int skin,
                                           const std::string& name, bool own_vertices = false);

  // A scene root with a mesh; skin -1 for none. Returns the node.
  int add_mesh_node(int mesh, int skin, const std::string& name);

  // The meshes with a vertex for which `moves` holds, and all without a range of their own; the
  // first if there are none, so that the targets' names are kept. (part_vertices.cpp)
  std::vector<MeshNode> moved_meshes(std::span<const MeshNode> meshes,
                                     const std::function<bool(std::size_t vertex)>& moves) const;

  // Morph targets for every primitive of the meshes, with names for viewers (extras.targetNames).
  void set_targets(std::span<const MeshNode> meshes,
                   const std::vector<std::map<std::string, int>>& targets,
                   std::span<const std::string> names);

  // Keys for the morph weights of the meshes where they leave a straight line, in an animation, or
  // after the last in a new one called `name`; `times` are the frames'. (weight_keys.cpp)
  void add_weight_keys(std::span<const MeshNode> meshes, const MorphWeights& weights,
                       std::span<const float> times, const std::string& name,
                       std::size_t animation = 0);
  void add_weight_channels(std::span<const MeshNode> meshes, int times, int weights,
                           const std::string& name, std::size_t animation = 0);

  // As add_floats(), for data streamed while the file is written, after all other data: append()
  // gets the bytes, in the order of these calls.
  int promise_floats(std::size_t count, int type, Use use);
  int promise_positions(std::size_t count);  // with bounds

  Status write(OutputFile& file);

  // The bounds for the promise_positions() calls, in their order.
  struct Bounds {
    Vec3f least, most;
  };
  // write() in steps, for streamed data: begin() writes what is known, append() the streamed data,
  // end() fills in the bounds. For a GLB to an output that cannot be rewritten (see OutputFile),
  // begin() needs the bounds; the bytes are the same.
  Status begin(OutputFile& file, std::span<const Bounds> bounds = {});
  Status append(std::span<const std::span<const std::byte>> parts);
  Status append(std::span<const std::byte> bytes) { return append(std::span(&bytes, 1)); }
  Status end(std::span<const Bounds> bounds);

  tinygltf::Model gltf;

 private:
  // A range of the buffer: owned bytes, a view, or keys that are read when they are written.
  struct Part {
    std::vector<std::byte> own;
    std::span<const std::byte> view;
    std::size_t to_read = 0;  // bytes
    std::span<const std::byte> bytes() const { return own.empty() ? view : own; }
  };

  struct VertexRange {
    std::size_t first = 0, count = 0;
  };
  // The ranges of the parts that have triangles, or none.
  std::vector<VertexRange> part_ranges(const Model& model) const;
  // The attributes of a range of the vertices; `in_place` changes the accessors themselves.
  std::map<std::string, int> attributes_of(const std::map<std::string, int>& whole,
                                           const VertexRange& range, bool in_place);
  // Calls `take` for the primitives that have vertices of their own, the first of all last, as its
  // accessors may be changed in place.
  void for_each_own_primitive(
      std::span<const MeshNode> meshes,
      const std::function<void(tinygltf::Primitive&, const VertexRange&, bool is_first)>& take);
  // Without texture coordinates that are all 0 and that no texture uses: a model has one list for
  // all parts, whether or not each had some.
  std::map<std::string, int> own_attributes(const tinygltf::Primitive& primitive,
                                            const std::map<std::string, int>& whole,
                                            const VertexRange& range) const;
  // Gives an accessor of add_displacements() the data of a range.
  void fill_displacements(std::span<const Vec3f> values, tinygltf::Accessor& accessor);
  Result<tinygltf::Primitive> primitive_of(const Model& model, const Model::Part& part,
                                           const std::map<std::string, int>& attributes,
                                           const VertexRange& range);
  void add_animation(const JointTracks& tracks, const std::string& name);
  int promise_keys(const JointTracks& tracks, std::size_t joint, bool rotations);
  // Reads the promised keys into the file, in place of zeros, or for null into the parts.
  Status read_keys(OutputFile* file);
  void find_bounds(tinygltf::Accessor& accessor) const;
  std::span<const std::byte> bytes_from(std::size_t offset) const;
  std::span<const std::byte> bytes_of(const tinygltf::Accessor& accessor) const;  // of its view

  void put(std::span<const std::byte> bytes, Keep keep);
  Result<int> add_image(const EncodedImage& image);
  Result<int> add_texture(const Texture& texture);
  int add_sampler(const Texture& texture);
  int add_accessor(std::span<const std::byte> bytes, int component, std::size_t component_size,
                   int type, Use use, Keep keep = Keep::copy, Filter filter = Filter::none);
  int add_accessor_of(std::size_t bytes, int component, std::size_t component_size, int type,
                      Use use);
  std::vector<std::byte>& own_part();
  void use_extension(const char* name);  // (materials.cpp)
  // A node below a joint of add_skeleton(), with a mark for the reader where it is no joint itself.
  int add_below_joint(int skin, std::size_t joint, const std::string& name,
                      const Transform& to_joint, const char* mark);
  // The whole file with its buffer views encoded (compress.cpp).
  Status write_compressed(OutputFile& file);
  // With as many bits as JointTrack has.
  int add_rotations(std::span<const Quatf> rotations, int bits);
  int add_translations(std::span<const Vec3f> translations, int exponent);
  int add_vector_keys(std::span<const Vec3f> values);
  // In a quantized file as the smallest whole numbers that have these values.
  int add_weights(std::span<const float> weights);
  Status begin_binary();
  Status begin_text();
  Status append_encoded(std::span<const std::byte> bytes);
  std::string json_text() const;
  void fill_in(std::span<const Bounds> bounds);
  void add_channel(tinygltf::Animation& animation, int node, const char* path, int times,
                   int values);

  // Where the keys of promise_keys() are.
  struct KeyPlace {
    std::uint64_t offset = 0;  // in the buffer
    std::size_t part = 0;
  };
  struct PromisedKeys {
    const JointTracks* tracks;
    std::vector<KeyPlace> translations, rotations;  // [joints]
  };

  const WriteOptions& options_;
  std::vector<Part> parts_;
  std::vector<PromisedKeys> promised_keys_;
  std::vector<int> outer_;  // [joints] the node that places a joint: its own, or the one above it
  std::map<int, Filter> filters_;                    // of buffer views
  std::map<int, std::vector<VertexRange>> ranges_;   // of the primitives of a mesh
  std::map<int, std::vector<Vec3f>> displacements_;  // of accessors without data
  std::map<std::vector<float>, int> times_;          // accessors of key times
  // Accessors of data, by component, type, filter and checksum of the bytes.
  std::map<std::tuple<int, int, Filter, std::uint64_t>, int> known_;
  std::uint64_t size_ = 0;      // bytes of the parts and the streamed data
  std::uint64_t promised_ = 0;  // bytes of the streamed data
  std::size_t bounds_ = 0;      // bounds that are not filled in yet
  OutputFile* file_ = nullptr;
  std::uint64_t data_begin_ = 0;      // of the buffer in the file
  std::string json_;                  // with space reserved for the bounds
  std::vector<std::byte> unencoded_;  // the last bytes, fewer than one Base64 group
  std::set<std::string> node_names_;
  std::map<std::string, int> sockets_;  // the nodes of add_sockets()
  std::map<std::string, int> materials_;
  std::map<int, std::set<std::string>> used_sets_;  // of texture coordinates, by materials
  std::map<const EncodedImage*, int> images_;
  std::map<std::pair<int, int>, int> textures_;  // by image and sampler
};

// Whether a model is valid and has triangles. Codes: gltf-empty-mesh and those of check(Model).
Status check_mesh(const Model& model);

// The preferred name of the mesh node; made unique, since joints keep their names.
std::string mesh_name(const WriteOptions& options);

// Normalised vectors; +Y for a zero vector.
std::vector<Vec3f> unit_vectors(std::span<const Vec3f> vectors);

// Calls `visit` for each set of texture coordinates with its name in glTF.
void for_each_coordinate_set(
    const Model& model,
    const std::function<void(const std::string& name, std::span<const Vec2f>)>& visit);

// The attributes shared by all meshes, with the vertices of `shape`; normals and tangents are
// normalised, as glTF requires.
std::map<std::string, int> add_shape(Document& document, const Model& model,
                                     const MeshShape& shape);

}  // namespace krok::gltf
