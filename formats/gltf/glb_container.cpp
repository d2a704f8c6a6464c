#include "formats/gltf/glb_container.h"

#include <fmt/format.h>

#include "core/bytes.h"

namespace krok::gltf {

namespace {

constexpr std::uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinChunk = 0x004E4942;
constexpr const char* kContainerHint =
    "the file is damaged or truncated; download or export it again";

Error broken(std::size_t offset, std::string message) {
  return Error("gltf-container", std::move(message), kContainerHint)
      .at_byte(static_cast<std::int64_t>(offset));
}

struct Chunk {
  std::uint32_t type = 0;
  std::size_t offset = 0;
  std::span<const std::byte> data;
};

Result<Chunk> read_chunk(ByteReader& reader) {
  const std::size_t start = reader.position();
  const auto length = reader.read<std::uint32_t>();
  Chunk chunk;
  chunk.type = reader.read<std::uint32_t>();
  if (!reader.ok()) return broken(start, "truncated chunk header");
  chunk.offset = reader.position();
  if (length > reader.remaining()) {
    return broken(start, fmt::format("a chunk of {} bytes where only {} bytes are left", length,
                                     reader.remaining()));
  }
  chunk.data = reader.take(length);
  return chunk;
}

Result<Container> open_glb(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  reader.take(4);
  const auto version = reader.read<std::uint32_t>();
  const auto length = reader.read<std::uint32_t>();
  if (!reader.ok()) return broken(0, "truncated GLB header");
  if (version != 2) {
    return Error("gltf-version", fmt::format("GLB version {}, expected 2", version),
                 "convert it to glTF 2.0")
        .at_byte(4);
  }
  if (length > bytes.size()) {
    return broken(
        8, fmt::format("the header specifies {} bytes, but the file has {}", length, bytes.size()));
  }
  if (length < 12) return broken(8, fmt::format("the header specifies {} bytes", length));

  ByteReader body(bytes.first(length));
  body.seek(12);
  auto json = read_chunk(body);
  if (!json) return json.error();
  if (json->type != kJsonChunk) return broken(12, "the first chunk is not JSON");
  Container container;
  container.binary = true;
  container.json = {reinterpret_cast<const char*>(json->data.data()), json->data.size()};
  container.json_offset = json->offset;
  // Chunks of unknown type must be skipped.
  while (body.remaining() > 0) {
    auto chunk = read_chunk(body);
    if (!chunk) return chunk.error();
    if (chunk->type != kBinChunk) continue;
    container.bin = chunk->data;
    break;
  }
  return container;
}

}  // namespace

Result<Container> open_container(std::span<const std::byte> bytes) {
  if (bytes.empty()) return Error("gltf-container", "the file is empty");
  ByteReader reader(bytes);
  if (reader.read<std::uint32_t>() == kMagic && reader.ok()) return open_glb(bytes);
  Container container;
  container.json = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (container.json.starts_with(kByteOrderMark)) {
    container.json.remove_prefix(kByteOrderMark.size());
    container.json_offset = kByteOrderMark.size();
  }
  const std::size_t first = container.json.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || container.json[first] != '{') {
    return Error("gltf-container",
                 "not a glTF file: starts neither with a GLB header nor with JSON",
                 "give a .glb or .gltf file");
  }
  return container;
}

}  // namespace krok::gltf
