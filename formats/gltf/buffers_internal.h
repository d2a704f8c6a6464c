#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "formats/gltf/glb_container.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/json_text_internal.h"

// Private to this folder: loads the buffers of a file.

namespace krok::gltf {

// A file that a glTF refers to: opened beside it, or from an archive.
struct SideFile {
  std::string path;
  std::optional<InputFile> file;
  std::vector<std::byte> unpacked;  // without `file`
  std::span<const std::byte> bytes() const {
    return file ? file->bytes() : std::span<const std::byte>(unpacked);
  }
};

// The buffers of a file: the GLB's BIN chunk, data URIs, external files. Views are valid as long as
// this object and the container's bytes.
struct Buffers {
  std::vector<std::span<const std::byte>> views;
  std::vector<std::vector<unsigned char>> decoded;
  std::vector<SideFile> files;
};

// Codes: gltf-buffer; for external files also those of InputFile.
Result<Buffers> open_buffers(const std::vector<BufferEntry>& entries, const Container& container,
                             const ReadOptions& options);

bool is_data_uri(const std::string& uri);

// Decodes a data URI; `what` names it in messages ("buffer 2"). Codes: gltf-buffer, gltf-too-large.
Result<std::vector<unsigned char>> decode_data_uri(const std::string& uri, const std::string& what);

// Opens a file that a glTF references by a relative URI; `what` names it in messages ("buffer").
// Codes: gltf-buffer for a URI that leaves the folder, and those of InputFile.
Result<SideFile> open_beside(const std::string& uri, const std::string& what,
                             const ReadOptions& options, std::uint64_t most_bytes);

}  // namespace krok::gltf
