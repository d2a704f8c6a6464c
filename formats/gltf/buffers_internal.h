#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/child_process.h"
#include "core/file.h"
#include "core/result.h"
#include "formats/gltf/glb_container_internal.h"
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

// buffers to `buffers` and let the model's buffer views and accessors refer to them, so that
// nothing behind them knows of compression. `most_bytes` limits what they append.

// EXT_meshopt_compression and KHR_meshopt_compression: each packed buffer view, with
// libmeshoptimizer, or the functions below for what only the second has. Codes: gltf-compression
// (parameters or data are invalid), gltf-too-large. Source: the extension's page in the glTF
// registry, appendices A (bitstreams) and B (filters).
Status unpack_meshopt(ParsedJson& parsed, Buffers& buffers, std::uint64_t most_bytes);

// Version 1 of the attribute codec, which libmeshoptimizer has since 0.23, and the COLOR filter.
// Source: KHR_meshopt_compression, appendices A and B. `to` has elements of `stride` bytes, a
// multiple of 4 up to 256 (colours: 4 or 8). (filters.cpp)
bool is_second_codec(std::span<const std::byte> packed);
// False if the data is invalid.
bool unpack_second_codec(std::span<const std::byte> packed, std::size_t stride,
                         std::span<std::byte> to);
void unfilter_colours(std::span<std::byte> colours, std::size_t stride);

// KHR_draco_mesh_compression: the indices and attributes of each packed primitive, with libdraco.
// Its decoder runs in a process of its own with limits, as it takes memory by what the data claims
// (see core/child_process.h). Codes: gltf-compression, gltf-too-large.
Status unpack_draco(ParsedJson& parsed, Buffers& buffers, std::uint64_t most_bytes,
                    const GivenLimits& given);

// What a buffer view of elements of `stride` bytes, a multiple of 4, is encoded to.
std::vector<unsigned char> encode_attributes(std::span<const std::byte> bytes, std::size_t stride);

}  // namespace krok::gltf
