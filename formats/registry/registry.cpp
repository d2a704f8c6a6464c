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

// Other kinds of files that users may pass by mistake, by their first bytes.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kOtherKinds = {
    {{"\x89PNG", "a PNG image"},
     {"\x1F\x8B", "a gzip archive"},
     {"BZh", "a bzip2 archive"},
     {"\xFD"
      "7zXZ",
      "an xz archive"},
     {"7z\xBC\xAF\x27\x1C", "a 7-Zip archive"},
     {"Rar!\x1A\x07", "a RAR archive"},
     {"\x76\x2F\x31\x01", "an OpenEXR image"},
     {"%PDF-", "a PDF document"},
     {"version https://git-lfs", "a Git LFS pointer, not the file itself"}}};

std::string_view text_of(std::span<const std::byte> content) {
  return {reinterpret_cast<const char*>(content.data()), content.size()};
}

// The text without a byte-order mark and leading white space.
std::string_view first_word(std::string_view text) {
  text = without_byte_order_mark(text);
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  return start == std::string_view::npos ? std::string_view() : text.substr(start);
}

// ASF or AMC, by the first section after comments.
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
  if (has(head, "\"krok.ragdoll/")) return Kind::ragdoll;
  return has(head, "\"asset\"") || has(tail, "\"asset\"") ? Kind::gltf : Kind::unknown;
}

// 3DS: begins with the main chunk, which has the length of the file or a known first subchunk.
bool is_3ds(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  if (text.size() < 16 || byte(0) != 0x4D || byte(1) != 0x4D) return false;
  const std::uint32_t length = byte(2) | byte(3) << 8 | byte(4) << 16 | byte(5) << 24;
  const std::uint32_t first = byte(6) | byte(7) << 8;
  return length == text.size() || first == 0x0002 || first == 0x3D3D || first == 0xB000;
}

// Consumes the next word of a text, skipping // comments.
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

// Kinds read by formats/assimp.
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

// Known formats: file extension, description for messages, and how to recognise the content. Tried
// in this order.
struct Format {
  Kind kind;
  std::string_view ending;  // without the dot
  std::string_view description;
  bool (*matches)(std::string_view content);
};

template <const Magic& magic>
bool begins_with(std::string_view content) {
  return content.starts_with(std::string_view(magic.data(), magic.size()));
}
template <Kind kind>
bool is_acclaim(std::string_view content) {
  return acclaim_kind(content) == kind;
}
template <Kind kind>
bool is_json(std::string_view content) {
  return json_kind(content) == kind;
}
template <Kind kind>
bool is_scene(std::string_view content) {
  return scene_kind(content) == kind;
}
bool is_pc2(std::string_view content) {
  return content.starts_with(std::string_view("POINTCACHE2\0", 12));
}
bool is_zip(std::string_view content) {
  return content.starts_with("PK\x03\x04");
}
bool is_glb(std::string_view content) {
  return content.starts_with("glTF");
}
bool is_bvh(std::string_view content) {
  return same_word(first_word(content).substr(0, kHierarchy.size()), kHierarchy);
}

constexpr auto kFormats = std::to_array<Format>({
    {Kind::anim, "anim", "a Krok motion (.anim)", begins_with<kAnimMagic>},
    {Kind::model, "model", "a Krok model (.model)", begins_with<kModelMagic>},
    {Kind::cam, "cam", "a Krok camera (.cam)", begins_with<kCamMagic>},
    {Kind::steps, "steps", "a Krok step library (.steps)", begins_with<kStepsMagic>},
    {Kind::pc2, "pc2", "a point cache (.pc2)", is_pc2},
    {Kind::glb, "glb", "a binary glTF file (.glb)", is_glb},
    {Kind::bvh, "bvh", "a BVH text file", is_bvh},
    {Kind::material, "material", "Krok materials (.material)", is_json<Kind::material>},
    {Kind::character, "character", "a Krok character (.character)", is_json<Kind::character>},
    {Kind::ragdoll, "ragdoll.json", "Krok bodies and joints (.ragdoll.json)",
     is_json<Kind::ragdoll>},
    {Kind::gltf, "gltf", "a glTF file (.gltf)", is_json<Kind::gltf>},
    {Kind::zip, "zip", "a ZIP archive", is_zip},
    {Kind::fbx, "fbx", "an FBX file", is_scene<Kind::fbx>},
    {Kind::collada, "dae", "a COLLADA file (.dae)", is_scene<Kind::collada>},
    {Kind::smd, "smd", "a Valve SMD file", is_scene<Kind::smd>},
    {Kind::ms3d, "ms3d", "a MilkShape file (.ms3d)", is_scene<Kind::ms3d>},
    {Kind::max_3ds, "3ds", "a 3DS file", is_scene<Kind::max_3ds>},
    {Kind::ase, "ase", "an ASE file", is_scene<Kind::ase>},
    {Kind::md5mesh, "md5mesh", "an MD5 mesh", is_scene<Kind::md5mesh>},
    {Kind::md5anim, "md5anim", "an MD5 motion (.md5anim)", is_scene<Kind::md5anim>},
    {Kind::asf, "asf", "an Acclaim skeleton (ASF)", is_acclaim<Kind::asf>},
    {Kind::amc, "amc", "an Acclaim motion (AMC)", is_acclaim<Kind::amc>},
});

const Format* find_format(Kind kind) {
  const auto found = std::ranges::find(kFormats, kind, &Format::kind);
  return found == kFormats.end() ? nullptr : &*found;
}

}  // namespace

std::string_view kind_name(Kind kind) {
  const Format* format = find_format(kind);
  return format == nullptr ? "unknown" : format->ending;
}

bool is_read_through_assimp(Kind kind) {
  return kind >= Kind::fbx;
}

Kind kind_of_content(std::span<const std::byte> content) {
  const std::string_view text = text_of(content);
  const auto found =
      std::ranges::find_if(kFormats, [&](const Format& format) { return format.matches(text); });
  return found == kFormats.end() ? Kind::unknown : found->kind;
}

Kind kind_of_name(const std::string& path) {
  const std::string ending = extension(path);
  if (ending.size() < 2) return Kind::unknown;
  if (ending == kOtherAnimEnding) return Kind::anim;
  const auto found =
      std::ranges::find(kFormats, std::string_view(ending).substr(1), &Format::ending);
  return found == kFormats.end() ? Kind::unknown : found->kind;
}

Kind identify(const std::string& path, std::span<const std::byte> content) {
  const Kind kind = kind_of_content(content);
  return kind != Kind::unknown ? kind : kind_of_name(path);
}

std::string_view describe_content(std::span<const std::byte> content) {
  if (content.empty()) return "an empty file";
  if (const Format* format = find_format(kind_of_content(content))) return format->description;
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
  if (found == Kind::glb || found == Kind::gltf) {
    return "krok-import converts it: --character NAME.character writes its mesh and skeleton, -o "
           "NAME.anim an animation";
  }
  if (found == Kind::anim && wanted == Kind::model) return "krok-body makes a model for a motion";
  const bool own = found >= Kind::anim && found <= Kind::ragdoll;
  if (own) return "perhaps two arguments are in the wrong order";
  return {};
}

}  // namespace krok::registry
