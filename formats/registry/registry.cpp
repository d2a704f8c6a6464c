#include "formats/registry/registry.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/file.h"
#include "core/text.h"

namespace krok::registry {

namespace {

constexpr std::string_view kHierarchy = "HIERARCHY";

// Other kinds of files that users may pass by mistake, by their first bytes.
constexpr auto kOtherKinds = std::to_array<std::pair<std::string_view, std::string_view>>(
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
     {"\x02P", "a C3D file (markers, no skeleton)"},
     {"PathFileType", "a TRC file (markers, no skeleton)"},
     {"{\"version\":1.3,\"people\"", "OpenPose JSON (2D points of one frame)"},
     {"%YAML", "YAML, as animations and scenes of Unity"},
     {"BLENDER", "a scene of Blender (export it as glTF)"},
     {"\x28\xB5\x2F\xFD", "a zstd archive, or a scene of Blender (export it as glTF)"},
     {"//Maya ASCII", "a scene of Maya (export it as FBX)"},
     {"FOR4", "a scene of Maya (export it as FBX)"},
     {"FOR8", "a scene of Maya (export it as FBX)"},
     {"animVersion", "curves of Maya without a skeleton (export FBX)"},
     {"MATLAB 5.0", "arrays of MATLAB (write them as .npz, with scipy and numpy)"},
     {"\x89HDF", "an HDF5 file (write its arrays as .npz, with numpy)"},
     {"\x80\x02", "a pickle of Python (write its arrays as .npz, with numpy)"},
     {"\x80\x03", "a pickle of Python (write its arrays as .npz, with numpy)"},
     {"\x80\x04", "a pickle of Python (write its arrays as .npz, with numpy)"},
     {"\x80\x05", "a pickle of Python (write its arrays as .npz, with numpy)"},
     {"version https://git-lfs", "a Git LFS pointer, not the file itself"}});

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

constexpr std::size_t kWindow = std::size_t{64} << 10;  // of text in which words are looked for

bool has_in_head(std::string_view text, std::string_view word) {
  return text.substr(0, kWindow).find(word) != std::string_view::npos;
}

constexpr std::string_view kMaterialSchema = "\"krok.material/";
constexpr std::string_view kCharacterSchema = "\"krok.character/";
constexpr std::string_view kRagdollSchema = "\"krok.ragdoll/";
constexpr std::string_view kCorrectivesSchema = "\"krok.correctives/";

template <const std::string_view& schema>
bool is_json(std::string_view text) {
  return first_word(text).starts_with('{') && has_in_head(text, schema);
}

bool is_gltf(std::string_view text) {
  const std::string_view tail = text.substr(text.size() - std::min(text.size(), kWindow));
  return first_word(text).starts_with('{') &&
         (has_in_head(text, "\"asset\"") || has_in_head(tail, "\"asset\""));
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

std::string_view word_at_start(std::string_view text) {
  text = text.substr(0, kWindow);
  return next_word(text);
}

// Wavefront OBJ, by its first statement after comments.
bool is_obj(std::string_view text) {
  for (text = first_word(text); text.starts_with('#'); text = first_word(text)) {
    text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
  }
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
  return word == "v" || word == "o" || word == "g" || word == "mtllib";
}

bool is_fbx(std::string_view text) {
  return text.starts_with("Kaydara FBX Binary") || first_word(text).starts_with("; FBX") ||
         word_at_start(text) == "FBXHeaderExtension:";
}
bool is_collada(std::string_view text) {
  return word_at_start(text).starts_with('<') && has_in_head(text, "<COLLADA");
}
bool is_smd(std::string_view text) {
  text = text.substr(0, kWindow);
  return next_word(text) == "version" && next_word(text) == "1" && next_word(text) == "nodes";
}
// A ZIP archive whose first file is an array: bytes 26 and 27 are the length of its name, from 30.
bool is_npz(std::string_view text) {
  if (!text.starts_with("PK\x03\x04") || text.size() < 30) return false;
  const auto length = static_cast<unsigned char>(text[26]) |
                      static_cast<std::size_t>(static_cast<unsigned char>(text[27])) << 8;
  return text.substr(30, length).ends_with(".npy");
}
bool is_ase(std::string_view text) {
  return same_word(word_at_start(text), "*3DSMAX_ASCIIEXPORT");
}
bool is_md5mesh(std::string_view text) {
  return word_at_start(text) == "MD5Version" && has_in_head(text, "numMeshes");
}
bool is_md5anim(std::string_view text) {
  return word_at_start(text) == "MD5Version" && has_in_head(text, "numAnimatedComponents");
}

bool is_text(std::string_view text) {
  const std::string_view head = text.substr(0, 512);
  return std::none_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) < 32 && c != '\t' && c != '\r' && c != '\n' && c != '\f';
  });
}

// The first bytes of a format, in its row.
template <std::size_t size>
struct Start {
  constexpr Start(const char (&given)[size]) {  // NOLINT: implicit, so that a row has a text
    std::copy(given, given + size, bytes);
  }
  char bytes[size];
};
template <Start start>
bool starts(std::string_view content) {
  return content.starts_with(std::string_view(start.bytes, sizeof(start.bytes) - 1));
}
template <const Magic& magic>
bool begins_with(std::string_view content) {
  return content.starts_with(std::string_view(magic.data(), magic.size()));
}
bool is_asf(std::string_view content) {
  return acclaim_kind(content) == Kind::asf;
}
bool is_amc(std::string_view content) {
  return acclaim_kind(content) == Kind::amc;
}
bool is_bvh(std::string_view content) {
  return same_word(first_word(content).substr(0, kHierarchy.size()), kHierarchy);
}

// What a format is apart from how it is read.
enum class Group : unsigned char {
  own,      // Krok's
  capture,  // of a performer's motion
  cache,    // of points
  gltf,
  archive,  // perhaps of a scene
  scene     // read by formats/assimp
};

struct Format {
  Kind kind;
  Group group;
  std::string_view endings;  // without the dots, separated by spaces
  std::string_view description;
  bool (*matches)(std::string_view content);

  std::string_view ending() const { return endings.substr(0, endings.find(' ')); }
};

#define KROK_ROW(kind, group, endings, description, recognises, ...) \
  Format{Kind::kind, Group::group, endings, description, recognises},
constexpr auto kFormats = std::to_array<Format>({KROK_FORMATS(KROK_ROW)});
#undef KROK_ROW

const Format* find_format(Kind kind) {
  const auto found = std::ranges::find(kFormats, kind, &Format::kind);
  return found == kFormats.end() ? nullptr : &*found;
}

bool is_of(Kind kind, Group group) {
  const Format* format = find_format(kind);
  return format != nullptr && format->group == group;
}

}  // namespace

std::string_view kind_name(Kind kind) {
  const Format* format = find_format(kind);
  return format == nullptr ? "unknown" : format->ending();
}

std::vector<std::string> endings_of(Kind kind) {
  std::vector<std::string> endings;
  const Format* format = find_format(kind);
  std::string_view rest = format == nullptr ? std::string_view() : format->endings;
  while (!rest.empty()) {
    const std::string_view one = rest.substr(0, rest.find(' '));
    endings.emplace_back(".").append(one);
    rest.remove_prefix(std::min(one.size() + 1, rest.size()));
  }
  return endings;
}

bool is_read_through_assimp(Kind kind) {
  return is_of(kind, Group::scene);
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
  for (const Format& format : kFormats) {
    const auto endings = endings_of(format.kind);
    if (std::ranges::find(endings, ending) != endings.end()) return format.kind;
  }
  return Kind::unknown;
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
  if ((text.size() > 8 && text.substr(4, 4) == "ftyp") || text.starts_with("\x1A\x45\xDF\xA3")) {
    return "a video (a pose estimator's joints are read as .npy or .npz)";
  }
  if (text.substr(0, 512).find("<OpenSimDocument") != std::string_view::npos) {
    return "a document of OpenSim (its models have no motion)";
  }
  if (first_word(text).starts_with('<')) return "an XML text file";
  if (is_text(text) && is_obj(text)) return "an OBJ mesh (without joints)";
  return is_text(text) ? kUnknownText : "a binary file of unknown kind";
}

std::string advice(Kind found, Kind wanted) {
  if (found == wanted) return {};
  if (wanted == Kind::steps)
    return "krok-fit makes it of walks, a folder or files, or of a description of examples (.json)";
  if (wanted == Kind::model && is_of(found, Group::capture)) {
    return "a mesh comes first, then motions: hero.model, or hero.character; krok-body makes one "
           "for a capture";
  }
  if (is_of(found, Group::capture) || is_of(found, Group::scene))
    return "import it with krok-import";
  if (is_of(found, Group::gltf)) {
    return "krok-import converts it: --save-character NAME.character writes its mesh and skeleton, "
           "-o "
           "NAME.anim an animation";
  }
  if (found == Kind::unknown && wanted == Kind::anim) {
    return "motions are .anim files and what krok-import reads: .bvh, .amc, .fbx, .glb and more";
  }
  if (found == Kind::unknown && wanted == Kind::model) {
    return "a mesh with joints is a .model, .character, .glb, .fbx or another that krok-import "
           "reads";
  }
  if (found == Kind::anim && wanted == Kind::model) return "krok-body makes a model for a motion";
  if ((found == Kind::model || found == Kind::character) && wanted == Kind::anim) {
    return "it has no motion: give a .anim, a capture or glTF; krok-skin writes a mesh as glTF or "
           "OBJ";
  }
  if (found == Kind::steps)
    return "krok-walk makes motions with it: krok walk IN.steps --goal 0m,5m";
  if (is_of(found, Group::own)) return "perhaps two arguments are in the wrong order";
  return {};
}

}  // namespace krok::registry
