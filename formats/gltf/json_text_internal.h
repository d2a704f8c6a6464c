#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/json_internal.h"
#include "core/result.h"
#include "formats/gltf/glb_container.h"

// Private to this folder: from the JSON of a glTF file to tinygltf's structures.

namespace krok::gltf {

struct BufferEntry {
  std::uint64_t byte_length = 0;
  bool has_uri = false;
  std::string uri;
};

struct CameraEntry {
  std::string name;
  bool perspective = true;
  double field_of_view = 0;  // vertical, radians; 0 where the file gives none that is a number
  // From extras.fieldsOfView, which formats/gltf/add_camera.h writes; not checked.
  double lens_rate = 0;
  std::vector<float> lens;
};

struct ParsedJson {
  tinygltf::Model model;  // without buffers, materials, images, cameras, extras and extensions
  std::vector<BufferEntry> buffers;
  std::vector<std::string> material_names;
  nlohmann::json look;  // an object: materials, textures, images and samplers as the file has them
  std::vector<CameraEntry> cameras;
  std::vector<std::vector<std::string>> target_names;  // [meshes], each possibly empty
};

// A text of an object; empty where it has none of that name.
std::string text_member(const nlohmann::json& object, const char* name);

// Refuses JSON that nests deeper than glTF ever needs, and versions and required extensions that
// are not known. tinygltf gets only those parts of the file that are used, so that what it does
// with others cannot matter. Codes gltf-json, gltf-version, gltf-extension, gltf-structure.
Result<ParsedJson> parse_json(const Container& container);

}  // namespace krok::gltf
