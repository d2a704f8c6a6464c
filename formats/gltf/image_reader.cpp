#include <fmt/format.h>

#include <filesystem>

#include "core/text.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/image_reader_internal.h"
#include "formats/gltf/json_text_internal.h"

namespace krok::gltf {

namespace {

using Json = nlohmann::json;

Error bad_image(std::string message, std::string hint = {}) {
  return Error("gltf-picture", std::move(message), std::move(hint));
}

std::shared_ptr<const EncodedImage> made(std::string name, std::string path,
                                         std::vector<std::byte> bytes) {
  return std::make_shared<const EncodedImage>(
      EncodedImage{std::move(name), std::move(path), std::move(bytes)});
}

}  // namespace

Images::Images(const ParsedJson& parsed, std::span<const std::span<const std::byte>> buffers,
               const ReadOptions& options)
    : parsed_(parsed), buffers_(buffers), options_(options), beside_left_(options.most_bytes) {
  for (const auto& buffer : buffers) in_buffers_left_ += buffer.size();
}

std::shared_ptr<const EncodedImage> Images::get(std::size_t index, Diagnostics& diagnostics) {
  const auto [place, added] = known_.try_emplace(index);
  if (!added) return place->second;
  auto image = read(index);
  if (image) {
    const auto facts = image_info((*image)->bytes);
    if (facts) return place->second = *std::move(image);
    image = facts.error();
  }
  Diagnostic warning = image.error();
  warning.severity = Severity::warning;
  warning.code = "gltf-picture";
  warning.message = fmt::format("image {} is left out: {}", index, warning.message);
  diagnostics.push_back(std::move(warning));
  return nullptr;
}

Result<std::shared_ptr<const EncodedImage>> Images::read(std::size_t image) {
  const auto images = parsed_.look.find("images");
  if (images == parsed_.look.end() || !images->is_array() || image >= images->size()) {
    return bad_image("it does not exist");
  }
  const Json& entry = (*images)[image];
  if (!entry.is_object()) return bad_image("it is not an object");
  const std::string name = text_member(entry, "name");
  if (const auto view = entry.find("bufferView"); view != entry.end()) {
    auto bytes = bytes_of_view(*view);
    if (!bytes) return bytes.error();
    return made(name, {}, *std::move(bytes));
  }
  const std::string uri = text_member(entry, "uri");
  if (!is_data_uri(uri)) return beside(uri, name);
  const auto decoded = decode_data_uri(uri, "the image");
  if (!decoded) return decoded.error();
  const auto bytes = std::as_bytes(std::span(*decoded));
  return made(name, {}, {bytes.begin(), bytes.end()});
}

Result<std::vector<std::byte>> Images::bytes_of_view(const Json& number) {
  const auto& views = parsed_.model.bufferViews;
  const auto index = number.is_number_unsigned() ? number.get<std::uint64_t>() : views.size();
  if (index >= views.size()) return bad_image("its buffer view does not exist");
  const tinygltf::BufferView& view = views[static_cast<std::size_t>(index)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= buffers_.size()) {
    return bad_image("its buffer does not exist");
  }
  const auto buffer = buffers_[static_cast<std::size_t>(view.buffer)];
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    return bad_image("it is outside its buffer");
  }
  if (view.byteLength > in_buffers_left_) return bad_image("images share bytes");
  in_buffers_left_ -= view.byteLength;
  const auto bytes = buffer.subspan(view.byteOffset, view.byteLength);
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Result<std::shared_ptr<const EncodedImage>> Images::beside(const std::string& uri,
                                                           const std::string& name) {
  if (uri.empty()) return bad_image("it has neither data nor a URI");
  const auto file = open_beside(uri, "image", options_, beside_left_);
  if (!file) return file.error();
  std::error_code error;
  const auto real = std::filesystem::canonical(file->path, error);
  const std::string place = error || options_.open ? file->path : real.string();
  if (const auto known = by_file_.find(place); known != by_file_.end()) return known->second;
  const auto bytes = file->bytes();
  beside_left_ -= std::min<std::uint64_t>(beside_left_, bytes.size());
  if (file->file) files_.push_back(file->path);
  return by_file_[place] = made(name, file->path, {bytes.begin(), bytes.end()});
}

}  // namespace krok::gltf
