#include "formats/registry/registry.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "core/file.h"
#include "core/text.h"

namespace krok::registry {

namespace {

constexpr std::string_view kHierarchy = "HIERARCHY";

// What people give by mistake, by its first bytes.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kOtherKinds = {
    {{"\x89PNG", "a PNG picture"},
     {"PK\x03\x04", "a ZIP archive"},
     {"\x1F\x8B", "a gzip archive"},
     {"BZh", "a bzip2 archive"},
     {"\xFD"
      "7zXZ",
      "an xz archive"},
     {"7z\xBC\xAF\x27\x1C", "a 7-Zip archive"},
     {"Rar!\x1A\x07", "a RAR archive"},
     {"\x76\x2F\x31\x01", "an OpenEXR picture"},
     {"%PDF-", "a PDF document"},
     {"version https://git-lfs", "a pointer of Git LFS, not the file that it stands for"}}};

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

Kind json_kind(std::string_view text) {
  if (!first_word(text).starts_with('{')) return Kind::unknown;
  constexpr std::size_t kWindow = std::size_t{64} << 10;
  const std::string_view head = text.substr(0, kWindow);
  const std::string_view tail = text.substr(text.size() - std::min(text.size(), kWindow));
  const auto has = [](std::string_view part, std::string_view word) {
    return part.find(word) != std::string_view::npos;
  };
  if (has(head, "\"krok.material/")) return Kind::material;
  if (has(head, "\"krok.character/")) return Kind::character;
  return has(head, "\"asset\"") || has(tail, "\"asset\"") ? Kind::gltf : Kind::unknown;
}

// 3DS: the main chunk, whose length is that of the file or whose first part is one that opens it.
bool is_3ds(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  if (text.size() < 16 || byte(0) != 0x4D || byte(1) != 0x4D) return false;
  const std::uint32_t length = byte(2) | byte(3) << 8 | byte(4) << 16 | byte(5) << 24;
  const std::uint32_t first = byte(6) | byte(7) << 8;
  return length == text.size() || first == 0x0002 || first == 0x3D3D || first == 0xB000;
}

// Words of a text that begins with them, past comments of two slashes.
std::string_view next_word(std::string_view& text) {
  text = first_word(text);
  while (text.starts_with("//")) {
    text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
    text = first_word(text);
  }
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
  text.remove_prefix(word.size());
  return word;
}

// What formats/assimp reads.
Kind scene_kind(std::string_view text) {
  constexpr std::size_t kWindow = std::size_t{64} << 10;
  const std::string_view head = text.substr(0, kWindow);
  const auto has = [&](std::string_view word) { return head.find(word) != std::string_view::npos; };
  if (text.starts_with("Kaydara FBX Binary")) return Kind::fbx;
  if (text.starts_with("MS3D000000")) return Kind::ms3d;
  if (is_3ds(text)) return Kind::max_3ds;
  std::string_view rest = head;
  const std::string_view first = next_word(rest);
  if (first_word(head).starts_with("; FBX") || first == "FBXHeaderExtension:") return Kind::fbx;
  if (first.starts_with('<')) return has("<COLLADA") ? Kind::collada : Kind::unknown;
  if (same_word(first, "*3DSMAX_ASCIIEXPORT")) return Kind::ase;
  if (first == "MD5Version") {
    if (has("numMeshes")) return Kind::md5mesh;
    return has("numAnimatedComponents") ? Kind::md5anim : Kind::unknown;
  }
  if (first == "version" && next_word(rest) == "1" && next_word(rest) == "nodes") return Kind::smd;
  return Kind::unknown;
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
    case Kind::steps:
      return "steps";
    case Kind::material:
      return "material";
    case Kind::character:
      return "character";
    case Kind::bvh:
      return "bvh";
    case Kind::asf:
      return "asf";
    case Kind::amc:
      return "amc";
    case Kind::pc2:
      return "pc2";
    case Kind::glb:
      return "glb";
    case Kind::gltf:
      return "gltf";
    case Kind::fbx:
      return "fbx";
    case Kind::collada:
      return "dae";
    case Kind::smd:
      return "smd";
    case Kind::ms3d:
      return "ms3d";
    case Kind::max_3ds:
      return "3ds";
    case Kind::ase:
      return "ase";
    case Kind::md5mesh:
      return "md5mesh";
    case Kind::md5anim:
      return "md5anim";
    case Kind::unknown:
      break;
  }
  return "unknown";
}

bool is_read_through_assimp(Kind kind) {
  return kind >= Kind::fbx;
}

Kind kind_of_content(std::span<const std::byte> content) {
  const std::string_view text = text_of(content);
  if (text.starts_with(view(kAnimMagic))) return Kind::anim;
  if (text.starts_with(view(kModelMagic))) return Kind::model;
  if (text.starts_with(view(kCamMagic))) return Kind::cam;
  if (text.starts_with(view(kStepsMagic))) return Kind::steps;
  if (text.starts_with(std::string_view("POINTCACHE2", 12))) return Kind::pc2;
  if (text.starts_with("glTF")) return Kind::glb;
  if (same_word(first_word(text).substr(0, kHierarchy.size()), kHierarchy)) return Kind::bvh;
  if (const Kind kind = json_kind(text); kind != Kind::unknown) return kind;
  const Kind scene = scene_kind(text);
  return scene != Kind::unknown ? scene : acclaim_kind(text);
}

Kind kind_of_name(const std::string& path) {
  const std::string ending = extension(path);
  for (const Kind kind :
       {Kind::anim,      Kind::model,   Kind::cam, Kind::steps,   Kind::material,
        Kind::character, Kind::bvh,     Kind::asf, Kind::amc,     Kind::pc2,
        Kind::glb,       Kind::gltf,    Kind::fbx, Kind::collada, Kind::smd,
        Kind::ms3d,      Kind::max_3ds, Kind::ase, Kind::md5mesh, Kind::md5anim}) {
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
    case Kind::steps:
      return "a Krok step library (.steps)";
    case Kind::material:
      return "Krok materials (.material)";
    case Kind::character:
      return "a Krok character (.character)";
    case Kind::bvh:
      return "a BVH text file";
    case Kind::asf:
      return "an Acclaim skeleton (ASF)";
    case Kind::amc:
      return "an Acclaim motion (AMC)";
    case Kind::pc2:
      return "a point cache (.pc2)";
    case Kind::glb:
      return "a binary glTF file (.glb)";
    case Kind::gltf:
      return "a glTF file (.gltf)";
    case Kind::fbx:
      return "an FBX file";
    case Kind::collada:
      return "a COLLADA file (.dae)";
    case Kind::smd:
      return "a Valve SMD file";
    case Kind::ms3d:
      return "a MilkShape file (.ms3d)";
    case Kind::max_3ds:
      return "a 3DS file";
    case Kind::ase:
      return "an ASE file";
    case Kind::md5mesh:
      return "an MD5 mesh";
    case Kind::md5anim:
      return "an MD5 motion (.md5anim)";
    case Kind::unknown:
      break;
  }
  const std::string_view text = text_of(content);
  for (const auto& [start, what] : kOtherKinds) {
    if (text.starts_with(start)) return what;
  }
  const std::string_view first = first_word(text);
  if (same_word(first.substr(0, 5), "<html") || same_word(first.substr(0, 9), "<!doctype")) {
    return "a web page (HTML)";
  }
  if (is_text(text) && (first.starts_with("{\"") || first.starts_with("[{"))) {
    return "a JSON text file";
  }
  if (first_word(text).starts_with('<')) return "an XML text file";
  return is_text(text) ? kUnknownText : "a binary file of unknown kind";
}

std::string advice(Kind found, Kind wanted) {
  if (found == wanted) return {};
  const bool capture = found == Kind::bvh || found == Kind::asf || found == Kind::amc;
  if (capture || is_read_through_assimp(found)) return "import it with krok-import";
  if (found == Kind::anim && wanted == Kind::model) return "krok-body makes a model for a motion";
  const bool own = found >= Kind::anim && found <= Kind::character;
  if (own) return "perhaps two arguments are in the wrong order";
  return {};
}

}  // namespace krok::registry
