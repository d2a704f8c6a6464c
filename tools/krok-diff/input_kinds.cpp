#include "tools/krok-diff/input_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "formats/io/formats.h"
#include "formats/registry/registry.h"

namespace krok::cli::diff {

namespace {

using registry::Kind;

constexpr std::array<char, 4> kExrMagic = {'\x76', '\x2f', '\x31', '\x01'};
constexpr std::string_view kPointCacheMagic = "POINTCACHE2";

template <typename Magic>
bool begins_with(std::span<const std::byte> bytes, const Magic& magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

}  // namespace

std::string description(InputKind kind) {
  switch (kind) {
    case InputKind::motion:
      return "a motion";
    case InputKind::model:
      return "a model (.model)";
    case InputKind::camera:
      return "a camera (.cam)";
    case InputKind::gltf:
      return "glTF";
    case InputKind::points:
      return "a point cache (.pc2)";
    case InputKind::morphs:
      break;
  }
  return "morph targets (.exr)";
}

const char* word_of(InputKind kind) {
  switch (kind) {
    case InputKind::motion:
      return "anim";
    case InputKind::model:
      return "model";
    case InputKind::camera:
      return "cam";
    case InputKind::gltf:
      return "gltf";
    case InputKind::points:
      return "pc2";
    case InputKind::morphs:
      break;
  }
  return "morphs";
}

Result<InputKind> kind_of(const InputFile& file) {
  const auto bytes = file.bytes();
  if (begins_with(bytes, kExrMagic)) return InputKind::morphs;
  if (begins_with(bytes, kPointCacheMagic)) return InputKind::points;
  if (io::is_motion(file)) return InputKind::motion;
  const Kind kind = registry::identify(file.path(), bytes);
  switch (kind) {
    case Kind::model:
      return InputKind::model;
    case Kind::cam:
      return InputKind::camera;
    case Kind::glb:
    case Kind::gltf:
      return InputKind::gltf;
    default:
      break;
  }
  return Error("diff-kind",
               fmt::format(
                   "this is {}; expected a motion (.anim, .bvh, .amc), .model, .cam, .glb, .gltf, "
                   ".pc2 or .exr file",
                   registry::describe_content(bytes)),
               registry::advice(kind, Kind::anim))
      .in_file(file.path());
}

}  // namespace krok::cli::diff
