#include "formats/gltf/gltf_reader.h"

#include "core/json_internal.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/glb_container_internal.h"
#include "formats/gltf/json_text_internal.h"

namespace krok::gltf {

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
