#include "formats/registry/registry.h"

#include <algorithm>

#include "core/file.h"
#include "core/text.h"

namespace krok::registry {

namespace {

constexpr std::string_view kHierarchy = "HIERARCHY";

std::string_view text_of(std::span<const std::byte> content) {
  return {reinterpret_cast<const char*>(content.data()), content.size()};
}

std::string_view view(const Magic& magic) {
  return {magic.data(), magic.size()};
}

// The text without a byte-order mark and leading white space.
std::string_view first_word(std::string_view text) {
  text = without_byte_order_mark(text);
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  return start == std::string_view::npos ? std::string_view() : text.substr(start);
}

// The first section of an Acclaim file, after comments, says which of the two it is.
Kind acclaim_kind(std::string_view text) {
  for (text = first_word(text); text.starts_with('#'); text = first_word(text)) {
    text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
  }
  if (!text.starts_with(':')) return Kind::unknown;
  const std::string_view section = text.substr(0, text.find_first_of(" \t\r\n"));
  for (const std::string_view word : {":version", ":name", ":units", ":root", ":bonedata",
                                      ":hierarchy", ":documentation", ":skin"}) {
    if (same_word(section, word)) return Kind::asf;
  }
  for (const std::string_view word :
       {":fully-specified", ":degrees", ":radians", ":samples-per-second", ":frame-range",
        ":asf-file", ":asf-path"}) {
    if (same_word(section, word)) return Kind::amc;
  }
  return Kind::unknown;
}

bool is_gltf_json(std::string_view text) {
  if (!first_word(text).starts_with('{')) return false;
  constexpr std::size_t kWindow = std::size_t{64} << 10;
  const std::string_view head = text.substr(0, kWindow);
  const std::string_view tail = text.substr(text.size() - std::min(text.size(), kWindow));
  return head.find("\"asset\"") != std::string_view::npos ||
         tail.find("\"asset\"") != std::string_view::npos;
}

bool is_text(std::string_view text) {
  const std::string_view head = text.substr(0, 512);
  return std::none_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) < 32 && c != '\t' && c != '\r' && c != '\n' && c != '\f';
  });
}

}  // namespace

std::string_view kind_name(Kind kind) {
  switch (kind) {
    case Kind::anim:
      return "anim";
    case Kind::model:
      return "model";
    case Kind::cam:
      return "cam";
    case Kind::bvh:
      return "bvh";
    case Kind::asf:
      return "asf";
    case Kind::amc:
      return "amc";
    case Kind::glb:
      return "glb";
    case Kind::gltf:
      return "gltf";
    case Kind::unknown:
      break;
  }
  return "unknown";
}

Kind kind_of_content(std::span<const std::byte> content) {
  const std::string_view text = text_of(content);
  if (text.starts_with(view(kAnimMagic))) return Kind::anim;
  if (text.starts_with(view(kModelMagic))) return Kind::model;
  if (text.starts_with(view(kCamMagic))) return Kind::cam;
  if (text.starts_with("glTF")) return Kind::glb;
  if (same_word(first_word(text).substr(0, kHierarchy.size()), kHierarchy)) return Kind::bvh;
  if (is_gltf_json(text)) return Kind::gltf;
  return acclaim_kind(text);
}

Kind kind_of_name(const std::string& path) {
  const std::string ending = extension(path);
  for (const Kind kind : {Kind::anim, Kind::model, Kind::cam, Kind::bvh, Kind::asf, Kind::amc,
                          Kind::glb, Kind::gltf}) {
    if (ending.size() > 1 && std::string_view(ending).substr(1) == kind_name(kind)) return kind;
  }
  return Kind::unknown;
}

Kind identify(const std::string& path, std::span<const std::byte> content) {
  const Kind kind = kind_of_content(content);
  return kind != Kind::unknown ? kind : kind_of_name(path);
}

std::string_view describe_content(std::span<const std::byte> content) {
  if (content.empty()) return "an empty file";
  switch (kind_of_content(content)) {
    case Kind::anim:
      return "a Krok motion (.anim)";
    case Kind::model:
      return "a Krok model (.model)";
    case Kind::cam:
      return "a Krok camera (.cam)";
    case Kind::bvh:
      return "a BVH text file";
    case Kind::asf:
      return "an Acclaim skeleton (ASF)";
    case Kind::amc:
      return "an Acclaim motion (AMC)";
    case Kind::glb:
      return "a binary glTF file (.glb)";
    case Kind::gltf:
      return "a glTF file (.gltf)";
    case Kind::unknown:
      break;
  }
  const std::string_view text = text_of(content);
  if (text.starts_with("Kaydara FBX Binary") || first_word(text).starts_with("; FBX")) {
    return "an FBX file";
  }
  if (text.starts_with("\x89PNG")) return "a PNG picture";
  if (text.starts_with("PK\x03\x04")) return "a ZIP archive";
  if (text.starts_with("\x1F\x8B")) return "a gzip archive";
  if (text.starts_with("\x76\x2F\x31\x01")) return "an OpenEXR picture";
  if (first_word(text).starts_with('<')) return "an XML text file";
  return is_text(text) ? kUnknownText : "a binary file of unknown kind";
}

std::string advice(Kind found, Kind wanted) {
  if (found == wanted) return {};
  const bool capture = found == Kind::bvh || found == Kind::asf || found == Kind::amc;
  if (capture) return "import it with krok-import";
  if (found == Kind::anim && wanted == Kind::model) return "krok-body makes a model for a motion";
  const bool own = found == Kind::anim || found == Kind::model || found == Kind::cam;
  if (own) return "perhaps two arguments are in the wrong order";
  return {};
}

}  // namespace krok::registry
