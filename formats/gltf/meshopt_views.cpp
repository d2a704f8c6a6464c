#include <fmt/format.h>
#include <meshoptimizer.h>

#include "core/text.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/reader_internal.h"

namespace krok::gltf {

namespace {

Error bad_view(const PackedView& packed, const std::string& what) {
  return Error("gltf-compression",
               fmt::format("buffer view {} (meshopt compression): {}", packed.view, what),
               kDamagedHint);
}

// What the extension's page requires of each mode and filter; the library asserts some of it.
Status check_parameters(const PackedView& packed) {
  const std::uint64_t stride = packed.stride;
  const bool attributes = packed.mode == "ATTRIBUTES";
  if (attributes && (stride == 0 || stride > 256 || stride % 4 != 0)) {
    return bad_view(
        packed, fmt::format("a stride of {} bytes; multiples of 4 up to 256 are valid", stride));
  }
  if (!attributes && packed.mode != "TRIANGLES" && packed.mode != "INDICES") {
    return bad_view(packed, fmt::format("mode '{}' is not known", shown(packed.mode)));
  }
  if (!attributes && stride != 2 && stride != 4) {
    return bad_view(packed, fmt::format("indices of {} bytes; 2 and 4 are valid", stride));
  }
  if (packed.mode == "TRIANGLES" && packed.count % 3 != 0) {
    return bad_view(packed, fmt::format("{} indices do not form whole triangles", packed.count));
  }
  const bool fits = packed.filter == "NONE" || packed.filter.empty() ||
                    ((packed.filter == "OCTAHEDRAL" || packed.filter == "COLOR") &&
                     (stride == 4 || stride == 8)) ||
                    (packed.filter == "QUATERNION" && stride == 8) ||
                    (packed.filter == "EXPONENTIAL" && stride % 4 == 0);
  const bool filtered = !packed.filter.empty() && packed.filter != "NONE";
  if (!fits || (filtered && !attributes)) {
    return bad_view(packed, fmt::format("filter '{}' does not fit elements of {} bytes",
                                        shown(packed.filter), stride));
  }
  return {};
}

Result<std::span<const std::byte>> packed_bytes(const PackedView& packed, const Buffers& buffers) {
  if (packed.buffer >= buffers.views.size()) {
    return bad_view(packed, fmt::format("buffer {} does not exist", packed.buffer));
  }
  const auto buffer = buffers.views[packed.buffer];
  if (packed.offset > buffer.size() || packed.length > buffer.size() - packed.offset) {
    return bad_view(packed, fmt::format("exceeds its buffer of {} bytes", buffer.size()));
  }
  return buffer.subspan(packed.offset, packed.length);
}

bool unpack(const PackedView& packed, std::span<const std::byte> bytes, unsigned char* to) {
  const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
  const std::size_t count = packed.count, stride = packed.stride;
  if (packed.mode == "TRIANGLES") {
    return meshopt_decodeIndexBuffer(to, count, stride, from, bytes.size()) == 0;
  }
  if (packed.mode == "INDICES") {
    return meshopt_decodeIndexSequence(to, count, stride, from, bytes.size()) == 0;
  }
  if (is_second_codec(bytes)) {
    if (!unpack_second_codec(bytes, stride, {reinterpret_cast<std::byte*>(to), count * stride})) {
      return false;
    }
  } else if (meshopt_decodeVertexBuffer(to, count, stride, from, bytes.size()) != 0) {
    return false;
  }
  if (packed.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(to, count, stride);
  if (packed.filter == "QUATERNION") meshopt_decodeFilterQuat(to, count, stride);
  if (packed.filter == "EXPONENTIAL") meshopt_decodeFilterExp(to, count, stride);
  if (packed.filter == "COLOR") {
    unfilter_colours({reinterpret_cast<std::byte*>(to), count * stride}, stride);
  }
  return true;
}

}  // namespace

Status unpack_meshopt(ParsedJson& parsed, Buffers& buffers, std::uint64_t most_bytes) {
  for (const PackedView& packed : parsed.packed_views) {
    if (packed.view >= parsed.model.bufferViews.size()) return bad_view(packed, "cannot be read");
    if (Status status = check_parameters(packed); !status) return status;
    const auto bytes = packed_bytes(packed, buffers);
    if (!bytes) return bytes.error();
    if (packed.count > most_bytes / packed.stride) {
      return Error("gltf-too-large",
                   fmt::format("buffer view {} unpacks to far more data than the file contains",
                               packed.view));
    }
    const std::uint64_t size = packed.count * packed.stride;
    most_bytes -= size;
    auto& unpacked = buffers.decoded.emplace_back(size);
    if (size > 0 && !unpack(packed, *bytes, unpacked.data())) {
      return bad_view(packed, "its data is invalid");
    }
    tinygltf::BufferView& view = parsed.model.bufferViews[packed.view];
    view.buffer = static_cast<int>(buffers.views.size());
    view.byteOffset = 0;
    view.byteLength = size;
    buffers.views.push_back(std::as_bytes(std::span(unpacked)));
  }
  return {};
}

}  // namespace krok::gltf
