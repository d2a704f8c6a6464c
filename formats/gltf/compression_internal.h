#pragma once

#include <cstdint>

#include "core/child_process.h"
#include "core/result.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/json_text_internal.h"

// Private to this folder: unpacks compressed data in front of the accessors. Both functions append
// buffers to `buffers` and let the model's buffer views and accessors refer to them, so that
// nothing behind them knows of compression. `most_bytes` limits what they append.

namespace krok::gltf {

// EXT_meshopt_compression: each packed buffer view, with libmeshoptimizer. Codes: gltf-compression
// (parameters or data are invalid), gltf-too-large. Source: the extension's page in the glTF
// registry, appendices A (bitstreams) and B (filters).
Status unpack_meshopt(ParsedJson& parsed, Buffers& buffers, std::uint64_t most_bytes);

// KHR_draco_mesh_compression: the indices and attributes of each packed primitive, with libdraco.
// Its decoder runs in a process of its own with limits, as it takes memory by what the data claims
// (see core/child_process.h). Codes: gltf-compression, gltf-too-large.
Status unpack_draco(ParsedJson& parsed, Buffers& buffers, std::uint64_t most_bytes,
                    const GivenLimits& given);

}  // namespace krok::gltf
