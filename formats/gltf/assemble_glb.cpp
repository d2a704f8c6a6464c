#include <fmt/format.h>

#include <limits>

#include "core/bytes.h"
#include "formats/gltf/assemble_glb_internal.h"

namespace krok::gltf {

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

}  // namespace krok::gltf
