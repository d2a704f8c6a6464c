#include "tools/krok-diff/input_kinds.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/registry/registry.h"

namespace krok::cli::diff {

namespace {

using registry::Kind;

struct KindRow {
  InputKind kind;
  const char* description;
  const char* word;
};
constexpr KindRow kKindRows[] = {{InputKind::motion, "a motion", "anim"},
                                 {InputKind::model, "a model (.model)", "model"},
                                 {InputKind::mesh, "a mesh (.obj)", "obj"},
                                 {InputKind::camera, "a camera (.cam)", "cam"},
                                 {InputKind::gltf, "glTF", "gltf"},
                                 {InputKind::points, "a point cache (.pc2)", "pc2"},
                                 {InputKind::morphs, "morph targets (.exr)", "morphs"}};

}  // namespace

std::string description(InputKind kind) {
  return std::ranges::find(kKindRows, kind, &KindRow::kind)->description;
}

const char* word_of(InputKind kind) {
  return std::ranges::find(kKindRows, kind, &KindRow::kind)->word;
}

Result<InputKind> kind_of(const InputFile& file) {
  if (file.text().starts_with("\x76\x2F\x31\x01")) return InputKind::morphs;
  if (file.text().starts_with("POINTCACHE2")) return InputKind::points;
  if (extension(file.path()) == ".obj") return InputKind::mesh;
  const auto bytes = file.bytes();
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
                   ".obj, .pc2 or .exr file",
                   registry::describe_content(bytes)),
               registry::advice(kind, Kind::anim))
      .in_file(file.path());
}

}  // namespace krok::cli::diff
