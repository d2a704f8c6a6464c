#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/json_internal.h"
#include "core/result.h"
#include "formats/gltf/glb_container_internal.h"
#include "nodes/scene.h"

// Private to this folder: parses the JSON of a glTF file into tinygltf's structures.
//
// tinygltf has the data model, reads it from JSON (here) and writes it as JSON (document.cpp). Its
// handling of files is not used: it holds all buffers and images in memory, follows paths out of
// the file's folder, trusts accessors and offsets, and writes a file in one piece. Containers,
// buffers, accessors and images are therefore read in this folder, with limits, and written as a
// stream.

namespace krok::gltf {

// Textures whose image is WebP, or KTX2 with Basis Universal.
inline constexpr const char* kWebp = "EXT_texture_webp";
inline constexpr const char* kBasisu = "KHR_texture_basisu";

struct BufferEntry {
  std::uint64_t byte_length = 0;
  bool has_uri = false;
  std::string uri;
  bool fallback = false;  // EXT_meshopt_compression: without data where all its views are packed
};

// A buffer view in EXT_meshopt_compression. Its values are not checked.
struct PackedView {
  std::size_t view = 0;
  std::uint64_t buffer = 0, offset = 0, length = 0;  // the packed bytes
  std::uint64_t stride = 0, count = 0;               // of what they unpack to
  std::string mode, filter;
};

// A primitive in KHR_draco_mesh_compression. Its values are not checked.
struct PackedPrimitive {
  std::size_t mesh = 0, primitive = 0;
  std::uint64_t view = 0;                           // buffer view of the packed bytes
  std::map<std::string, std::uint64_t> attributes;  // identifiers in the packed mesh
};

// A node in EXT_mesh_gpu_instancing. Its values are not checked.
struct InstancedNode {
  std::size_t node = 0;
  std::map<std::string, int> attributes;  // accessors; -1 where they are not valid
};

// extras of nodes that Krok adds to name a joint as an eye, or a place at one: {"krok": "eye"}.
inline constexpr const char* kMark = "krok";
inline constexpr const char* kEye = "eye";
inline constexpr const char* kSocket = "socket";

// extras of animations: the rate of the frames that their keys are on, {"rate": 7}.
inline constexpr const char* kRate = "rate";

// An animation channel of KHR_animation_pointer. Its values are not checked.
struct PointerChannel {
  std::size_t animation = 0;
  int sampler = -1;
  std::string pointer;  // "/cameras/0/perspective/yfov"
  int camera = -1;      // whose field of view it is; -1 if it is another property
};

struct ParsedJson {
  tinygltf::Model model;  // without buffers, materials, images, cameras, extras and extensions
  std::vector<BufferEntry> buffers;
  std::vector<std::string> material_names;
  nlohmann::json look;  // an object: the file's materials, textures, images and samplers
  // With values as they are: the field of view is 0 if missing or not a number, the lens is that of
  // extras.fieldsOfView (see add_camera.h).
  std::vector<nodes::Camera> cameras;
  std::vector<std::vector<std::string>> target_names;  // [meshes], may be empty
  std::vector<bool> lights;  // [nodes], whether they carry a light (KHR_lights_punctual)
  std::vector<bool> marked;  // [nodes], whether Krok wrote them to name a joint as an eye
  std::vector<bool> hidden;  // [nodes], by themselves (KHR_node_visibility)
  std::vector<InstancedNode> instanced;
  // Without those of a node's transform or weights, which are in `model` as channels of the node.
  std::vector<PointerChannel> pointers;
  std::vector<double> rates;           // [animations], of their extras; 0 without
  std::vector<std::string> not_shown;  // as nodes::Scene::not_shown
  std::vector<std::vector<MaterialParameter>> node_parameters;  // [nodes], of cameras and lights
  std::vector<MaterialParameter> properties;                    // as nodes::Scene::properties
  std::vector<PackedView> packed_views;
  std::vector<PackedPrimitive> packed_primitives;
};

// A member of an object; null if it is none or has no such member.
const nlohmann::json& member(const nlohmann::json& object, std::string_view name);
// A string member; empty if there is none.
std::string text_member(const nlohmann::json& object, const char* name);

// A property as numbers where it is one or a list of them, else as text.
MaterialParameter parameter_of(std::string name, const nlohmann::json& value);

// Takes the channels of KHR_animation_pointer; those of a node's own properties become channels as
// glTF has them without the extension.
std::vector<PointerChannel> take_pointers(nlohmann::json& json);

// Rejects JSON nested deeper than glTF needs, and unsupported versions and required extensions.
// Passes only the parts of the file that are used to tinygltf, to limit its exposure to malformed
// input. Codes: gltf-json, gltf-version, gltf-extension, gltf-structure.
Result<ParsedJson> parse_json(const Container& container);

}  // namespace krok::gltf
