#include "formats/io/formats.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/text.h"
#include "formats/io/readers_internal.h"

namespace krok::io {

namespace {

using registry::Kind;

constexpr auto kOwnFormats = std::to_array<Format>({
    {.kind = Kind::anim, .read_motion = read_anim},
    {.kind = Kind::bvh, .open_capture = open_bvh},
    {.kind = Kind::amc, .open_capture = open_amc},
    {.kind = Kind::asf, .open_capture = open_asf},
    {.kind = Kind::model, .read_model = read_model},
    {.kind = Kind::character, .read_model = read_character},
    {.kind = Kind::glb, .read_scene = read_gltf},
    {.kind = Kind::gltf, .read_scene = read_gltf},
    {.kind = Kind::zip, .read_scene = read_zipped_gltf},
    {.kind = Kind::fbx, .read_scene = read_through_assimp},
    {.kind = Kind::collada, .read_scene = read_through_assimp},
    {.kind = Kind::smd, .read_scene = read_through_assimp},
    {.kind = Kind::ms3d, .read_scene = read_through_assimp},
    {.kind = Kind::max_3ds, .read_scene = read_through_assimp},
    {.kind = Kind::ase, .read_scene = read_through_assimp},
    {.kind = Kind::md5mesh, .read_scene = read_through_assimp},
    {.kind = Kind::md5anim, .read_scene = read_through_assimp},
});

constexpr Format kNone;

std::vector<Format>& table() {
  static std::vector<Format> rows(kOwnFormats.begin(), kOwnFormats.end());
  return rows;
}

bool reads_motion(const Format& format) {
  return format.kind != Kind::asf &&
         (format.read_motion != nullptr || format.open_capture != nullptr);
}

}  // namespace

std::span<const Format> formats() {
  return table();
}

void add_format(const Format& format) {
  table().push_back(format);
}

const Format& format_of(Kind kind) {
  if (kind == Kind::unknown) return kNone;
  const auto found = std::ranges::find(table(), kind, &Format::kind);
  return found == table().end() ? kNone : *found;
}

const Format& format_of(const InputFile& file) {
  const Kind kind = registry::identify(file.path(), file.bytes());
  if (kind != Kind::unknown) return format_of(kind);
  for (const Format& format : table()) {
    if (format.recognises != nullptr && format.recognises(file.bytes())) return format;
  }
  const std::string ending = extension(file.path());
  for (const Format& format : table()) {
    if (!format.ending.empty() && ending == "." + std::string(format.ending)) return format;
  }
  return kNone;
}

bool is_motion(const InputFile& file) {
  const Format& format = format_of(file);
  return reads_motion(format);
}

std::vector<std::string> motion_endings() {
  std::vector<std::string> endings;
  for (const Format& format : table()) {
    if (!reads_motion(format)) continue;
    const std::string_view ending =
        format.kind == Kind::unknown ? format.ending : registry::kind_name(format.kind);
    if (!ending.empty()) endings.push_back("." + std::string(ending));
    if (format.kind == Kind::anim) endings.emplace_back(registry::kOtherAnimEnding);
  }
  return endings;
}

}  // namespace krok::io
