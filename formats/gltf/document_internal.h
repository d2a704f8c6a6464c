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

  // The default material under this name, made once.
  int add_material(const std::string& name);

  // Primitives for the parts of a model, all with the same attributes.
  Result<int> add_mesh(const Model& model, const std::map<std::string, int>& attributes,
                       const std::string& name);

  // A root of the scene with a mesh; skin -1 for none. Returns the node.
  int add_mesh_node(int mesh, int skin, const std::string& name);

  // Morph targets for every primitive of a mesh, and an animation of its node's weights that shows
  // the mesh itself at the first time and target i - 1 alone at time i.
  void add_morph_motion(int mesh, int node, const std::vector<std::map<std::string, int>>& targets,
                        std::span<const float> times, const std::string& name);

  // Room for so many bytes of data, to save copies.
  void reserve(std::size_t bytes) { own_part().reserve(own_part().size() + bytes); }

  Status write(OutputFile& file);

  tinygltf::Model gltf;

 private:
  // A stretch of the buffer: bytes of its own, or somebody else's.
  struct Part {
    std::vector<std::byte> own;
    std::span<const std::byte> view;
    std::span<const std::byte> bytes() const { return own.empty() ? view : own; }
  };

  int add_accessor(std::span<const std::byte> bytes, int component, std::size_t component_size,
                   int type, Use use, Keep keep = Keep::copy);
  std::vector<std::byte>& own_part();
  Status write_binary(OutputFile& file);
  Status write_text(OutputFile& file);
  void add_channel(tinygltf::Animation& animation, int node, const char* path, int times,
                   int values);

  const WriteOptions& options_;
  std::vector<Part> parts_;
  std::uint64_t size_ = 0;  // of the parts together
  std::set<std::string> node_names_;
  std::map<std::string, int> materials_;
};

}  // namespace krok::gltf
