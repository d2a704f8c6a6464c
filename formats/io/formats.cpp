#include "formats/io/formats.h"

#include <algorithm>
#include <array>

#include "formats/io/readers_internal.h"

namespace krok::io {

namespace {

using registry::Kind;

constexpr auto kFormats = std::to_array<Format>({
    {.kind = Kind::anim, .read_motion = read_anim},
    {.kind = Kind::bvh, .open_capture = open_bvh},
    {.kind = Kind::amc, .open_capture = open_amc},
    {.kind = Kind::asf, .open_capture = open_asf},
    {.kind = Kind::model, .read_model = read_model},
    {.kind = Kind::character, .read_model = read_character},
    {.kind = Kind::glb, .read_scene = read_gltf},
    {.kind = Kind::gltf, .read_scene = read_gltf},
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

}  // namespace

std::span<const Format> formats() {
  return kFormats;
}

const Format& format_of(Kind kind) {
  const auto found = std::ranges::find(kFormats, kind, &Format::kind);
  return found == kFormats.end() ? kNone : *found;
}

const Format& format_of(const InputFile& file) {
  return format_of(registry::identify(file.path(), file.bytes()));
}

}  // namespace krok::io
