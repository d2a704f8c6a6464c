#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/child_process.h"
#include "core/result.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/json_text_internal.h"

// Private to this folder: unpacks compressed data in front of the accessors. Both functions append
// buffers to `buffers` and let the model's buffer views and accessors refer to them, so that
// nothing behind them knows of compression. `most_bytes` limits what they append.

namespace krok::gltf {

// EXT_meshopt_compression and KHR_meshopt_compression: each packed buffer view, with
// libmeshoptimizer, or the functions below for what only the second has. Codes: gltf-compression
// (parameters or data are invalid), gltf-too-large. Source: the extension's page in the glTF
// registry, appendices A (bitstreams) and B (filters).
Status unpack_meshopt(ParsedJson& parsed, Buffers& buffers, std::uint64_t most_bytes);

// Version 1 of the attribute codec, which libmeshoptimizer has since 0.23, and the COLOR filter.
// Source: KHR_meshopt_compression, appendices A and B. `to` has elements of `stride` bytes, a
// multiple of 4 up to 256 (colours: 4 or 8). (vertex_codec.cpp)
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
