#include "formats/gltf/glb_container_internal.h"

#include <fmt/format.h>

#include <limits>

#include "core/bytes.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/json_text_internal.h"

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

using OrderedJson = nlohmann::ordered_json;

std::size_t append_aligned(std::span<const std::byte> bytes, std::vector<std::byte>& buffer) {
  const std::size_t begin = buffer.size();
  buffer.insert(buffer.end(), bytes.begin(), bytes.end());
  buffer.resize((buffer.size() + kAlignment - 1) / kAlignment * kAlignment);
  return begin;
}

Result<std::vector<std::byte>> assemble_glb(OrderedJson& json, std::span<const std::byte> data,
                                            std::span<const OrderedJson> more_buffers) {
  if (data.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
    return Error("gltf-too-large",
                 fmt::format("{} bytes exceed the size limit of a GLB", data.size()));
  }
  if (!data.empty()) {
    json["buffers"] = OrderedJson::array({{{"byteLength", data.size()}}});
    for (const OrderedJson& buffer : more_buffers) json["buffers"].push_back(buffer);
  }
  std::string text = json_text(json);
  while (text.size() % kAlignment != 0) text += ' ';
  constexpr std::uint32_t kHeader = 12, kChunk = 8;
  const std::size_t size =
      kHeader + kChunk + text.size() + (data.empty() ? 0 : kChunk + data.size());
  ByteWriter out;
  out.append_text("glTF");
  out.write(std::uint32_t{2});
  out.write(static_cast<std::uint32_t>(size));
  out.write(static_cast<std::uint32_t>(text.size()));
  out.append_text("JSON");
  out.append_text(text);
  if (!data.empty()) {
    out.write(static_cast<std::uint32_t>(data.size()));
    out.append_text(std::string_view("BIN\0", 4));
    out.buffer().insert(out.buffer().end(), data.begin(), data.end());
  }
  return std::move(out.buffer());
}

namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kGreyPixel =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR42mNoAAAAggCB2kUIOwAAAABJRU5ErkJggg==";

class Packer {
 public:
  Packer(OrderedJson& json, const ReadOptions& options) : json_(json), options_(options) {}

  void put_buffers(const Buffers& buffers) {
    std::vector<std::size_t> begins;
    for (const auto& view : buffers.views) begins.push_back(put(view));
    for (const SideFile& file : buffers.files) packed_.files.push_back(file.path);
    if (!json_.contains("bufferViews")) return;
    for (OrderedJson& view : json_["bufferViews"]) {
      if (!view.is_object()) continue;
      const std::size_t buffer = number(view, "buffer"), offset = number(view, "byteOffset");
      if (buffer >= begins.size()) continue;
      view["buffer"] = 0;
      view["byteOffset"] = begins[buffer] + offset;
    }
  }

  void put_images() {
    if (!json_.contains("images") || !json_["images"].is_array()) return;
    for (OrderedJson& image : json_["images"]) {
      if (!image.is_object() || !image.contains("uri") || !image["uri"].is_string()) continue;
      const auto uri = image["uri"].get<std::string>();
      if (!is_data_uri(uri)) put_image(uri, image);
    }
  }

  Result<PackedGlb> finish() {
    auto bytes = assemble_glb(json_, bin_);
    if (!bytes) return bytes.error();
    packed_.bytes = *std::move(bytes);
    return std::move(packed_);
  }

 private:
  static std::size_t number(const OrderedJson& object, const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_number_unsigned() ? found->get<std::size_t>() : 0;
  }

  std::size_t put(std::span<const std::byte> bytes) { return append_aligned(bytes, bin_); }

  void put_image(const std::string& uri, OrderedJson& image) {
    const auto file = open_beside(uri, "image", options_, options_.most_bytes);
    if (!file) {
      Diagnostic diagnostic = file.error();
      diagnostic.severity = Severity::warning;
      diagnostic.code = "gltf-image";
      packed_.diagnostics.push_back(std::move(diagnostic));
      image["uri"] = kGreyPixel;
      return;
    }
    packed_.files.push_back(file->path);
    const auto bytes = file->bytes();
    const bool is_jpeg =
        bytes.size() > 1 && bytes[0] == std::byte{0xFF} && bytes[1] == std::byte{0xD8};
    const bool is_webp =
        bytes.size() > 3 && bytes[0] == std::byte{'R'} && bytes[1] == std::byte{'I'};
    const std::size_t begin = put(bytes);
    OrderedJson& views = json_["bufferViews"];
    if (!views.is_array()) views = OrderedJson::array();
    views.push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size()}});
    image.erase("uri");
    image["bufferView"] = views.size() - 1;
    image["mimeType"] = is_jpeg ? "image/jpeg" : is_webp ? "image/webp" : "image/png";
  }

  OrderedJson& json_;
  const ReadOptions& options_;
  std::vector<std::byte> bin_;
  PackedGlb packed_;
};

}  // namespace

Result<PackedGlb> pack_glb(std::span<const std::byte> gltf, const ReadOptions& options) {
  if (auto sound = read(gltf, options); !sound) return sound.error();
  const auto container = open_container(gltf);
  if (!container) return container.error();
  const auto parsed = parse_json(*container);
  if (!parsed) return parsed.error();
  const auto buffers = open_buffers(parsed->buffers, *container, options);
  if (!buffers) return buffers.error();
  OrderedJson json = parse_ordered_json(container->json);
  Packer packer(json, options);
  packer.put_buffers(*buffers);
  packer.put_images();
  return packer.finish();
}

Result<std::vector<std::byte>> plain_channels(std::span<const std::byte> glb) {
  const auto container = open_container(glb);
  if (!container) return container.error();
  if (container->json.find("KHR_animation_pointer") == std::string_view::npos) {
    return std::vector<std::byte>(glb.begin(), glb.end());
  }
  nlohmann::json json = nlohmann::json::parse(container->json);
  take_pointers(json);
  OrderedJson plain = json;
  std::vector<OrderedJson> more;
  for (const OrderedJson& buffer : plain.value("buffers", OrderedJson::array())) {
    more.push_back(buffer);
  }
  if (!container->bin.empty() && !more.empty()) more.erase(more.begin());
  return assemble_glb(plain, container->bin, more);
}

}  // namespace krok::gltf
