#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/joint_tracks.h"
#include "scene/clip.h"
#include "scene/model.h"

// A glTF file while it is put together: one buffer, one scene. Only for the writer's own files.

namespace krok::gltf {

class Document {
 public:
  explicit Document(const WriteOptions& options);

  enum class Use { vertices, indices, data };

  // Whether values are copied, or must live and stay as they are until write().
  enum class Keep { copy, view };

  // Appends values in their own buffer view; returns the accessor. `Values` are floats, vectors of
  // floats, or unsigned integers, contiguous, and not empty. `bounds` writes min and max.
  int add_floats(std::span<const float> values, int type, Use use, bool bounds,
                 Keep keep = Keep::copy);
  int add_positions(std::span<const Vec3f> values, Use use = Use::vertices);  // with bounds
  int add_vectors(std::span<const Vec3f> values, Use use = Use::vertices);
  int add_integers(std::span<const std::uint32_t> values, int type, std::uint32_t largest, Use use);

  // `wanted`, or with a number appended what no other node has.
  std::string unique_node_name(const std::string& wanted);

  // Nodes for all joints, the first a root of the scene; a skin of them with the inverse reference
  // transforms; an animation, if there are times. The tracks must live until write(). Returns the
  // skin.
  int add_skeleton(const Skeleton& skeleton, const JointTracks& tracks, const std::string& name);

  // The material of this name out of WriteOptions::materials, otherwise the usual one under it;
  // made once, as are its pictures. Those need texture coordinates, normal textures tangents too:
  // they are left out for meshes without these attributes (which are the same for all calls).
  // Codes: those of picture_facts(). (materials.cpp)
  Result<int> add_material(const std::string& name, const std::map<std::string, int>& attributes);

  // Nodes for eyes under the joints that add_skeleton() made. Code: gltf-structure.
  Status add_eyes(const Skeleton& skeleton, int skin, std::span<const Character::Eye> eyes);

  // Primitives for the parts of a model, all with the same attributes.
  Result<int> add_mesh(const Model& model, const std::map<std::string, int>& attributes,
                       const std::string& name);

  // A root of the scene with a mesh; skin -1 for none. Returns the node.
  int add_mesh_node(int mesh, int skin, const std::string& name);

  // Morph targets for every primitive of a mesh, under names that viewers show.
  void set_targets(int mesh, const std::vector<std::map<std::string, int>>& targets,
                   std::span<const std::string> names);

  // Keys of the weights [times x targets] of a node's mesh, in the animation there is, or in one of
  // this name.
  void add_weight_keys(int node, std::span<const float> times, std::span<const float> weights,
                       const std::string& name);
  void add_weight_channel(int node, int times, int weights, const std::string& name);

  // The same as add_floats() for data that are told while the file is written, after all others:
  // append() is given their bytes, in the order in which they were promised.
  int promise_floats(std::size_t count, int type, Use use);
  int promise_positions(std::size_t count);  // with bounds

  Status write(OutputFile& file);

  // The bounds of what promise_positions() promised, in that order.
  struct Bounds {
    Vec3f least, most;
  };
  // The same in parts, for promised data: begin() writes what is known, append() what follows,
  // end() fills in the bounds. A GLB that cannot be overwritten (see OutputFile) needs them in
  // begin() already; the bytes are the same.
  Status begin(OutputFile& file, std::span<const Bounds> bounds = {});
  Status append(std::span<const std::span<const std::byte>> parts);
  Status append(std::span<const std::byte> bytes) { return append(std::span(&bytes, 1)); }
  Status end(std::span<const Bounds> bounds);

  tinygltf::Model gltf;

 private:
  // A stretch of the buffer: bytes of its own, or somebody else's.
  struct Part {
    std::vector<std::byte> own;
    std::span<const std::byte> view;
    std::span<const std::byte> bytes() const { return own.empty() ? view : own; }
  };

  void put(std::span<const std::byte> bytes, Keep keep);
  Result<int> add_image(const EncodedImage& image);
  Result<int> add_texture(const Texture& texture);
  int add_sampler(const Texture& texture);
  int add_accessor(std::span<const std::byte> bytes, int component, std::size_t component_size,
                   int type, Use use, Keep keep = Keep::copy);
  int add_accessor_of(std::size_t bytes, int component, std::size_t component_size, int type,
                      Use use);
  std::vector<std::byte>& own_part();
  Status begin_binary();
  Status begin_text();
  Status append_encoded(std::span<const std::byte> bytes);
  std::string json_text() const;
  void fill_in(std::span<const Bounds> bounds);
  void add_channel(tinygltf::Animation& animation, int node, const char* path, int times,
                   int values);

  const WriteOptions& options_;
  std::vector<Part> parts_;
  std::uint64_t size_ = 0;      // of the parts and of what is promised together
  std::uint64_t promised_ = 0;  // of these, what is promised
  std::size_t bounds_ = 0;      // how many are not filled in yet
  OutputFile* file_ = nullptr;
  std::string json_;                  // with room for the bounds, until they are filled in
  std::vector<std::byte> unencoded_;  // the last of a text's data
  std::set<std::string> node_names_;
  std::map<std::string, int> materials_;
  std::map<const EncodedImage*, int> images_;
  std::map<std::pair<int, int>, int> textures_;  // by picture and sampler
};

}  // namespace krok::gltf
