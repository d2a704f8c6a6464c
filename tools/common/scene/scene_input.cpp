#include "tools/common/scene/scene_input.h"

#include "formats/assimp/assimp_reader.h"
#include "tools/common/gltf/gltf_input.h"

namespace krok {

using registry::Kind;

bool is_scene(Kind kind) {
  return kind == Kind::glb || kind == Kind::gltf || registry::is_read_through_assimp(kind);
}

Result<nodes::Scene> read_scene(const InputFile& input, Kind kind, ToolContext& context,
                                bool with_materials) {
  if (!registry::is_read_through_assimp(kind)) return read_gltf(input, context, with_materials);
  if (input.path() == "-") {
    return Error("assimp-kind",
                 "only BVH, Acclaim's formats and GLB can be read from standard input")
        .in_file(input.path());
  }
  if (kind == Kind::md5anim) context.chose_beside(input.path(), ".md5mesh");
  if (kind == Kind::md5mesh) context.chose_beside(input.path(), ".md5anim");
  assimp::ReadOptions options;
  options.with_materials = with_materials;
  return with_its_files(assimp::read_file(input.path(), options), input, context);
}

}  // namespace krok
