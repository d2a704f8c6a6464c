#include "formats/io/open_scene.h"

#include "core/path_inside.h"
#include "formats/assimp/assimp_reader.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/io/readers_internal.h"

namespace krok::io {

namespace {

// Opens the other files that a scene was read from, and names its file in its diagnostics.
Result<nodes::Scene> with_its_files(Result<nodes::Scene> scene, const InputFile& file,
                                    Inputs& inputs) {
  if (!scene) return std::move(scene.error()).in_file(file.path());
  for (const std::string& path : scene->files) {
    if (path == file.path()) continue;
    if (const auto other = inputs.open_input(path); !other) return other.error();
  }
  for (Diagnostic& diagnostic : scene->diagnostics) {
    if (diagnostic.where.file.empty()) diagnostic.where.file = file.path();
  }
  return scene;
}

}  // namespace

Result<nodes::Scene> read_gltf(const InputFile& file, Inputs& inputs, bool with_materials) {
  gltf::ReadOptions options;
  options.with_materials = with_materials;
  if (file.path() != "-") options.folder = folder_of(file.path());
  return with_its_files(gltf::read(file.bytes(), options), file, inputs);
}

Result<nodes::Scene> read_through_assimp(const InputFile& file, Inputs& inputs,
                                         bool with_materials) {
  if (file.path() == "-") {
    return Error("assimp-kind",
                 "only BVH, Acclaim's formats and GLB can be read from standard input")
        .in_file(file.path());
  }
  const registry::Kind kind = registry::identify(file.path(), file.bytes());
  if (kind == registry::Kind::md5anim) inputs.depends_on_neighbours(file.path(), ".md5mesh");
  if (kind == registry::Kind::md5mesh) inputs.depends_on_neighbours(file.path(), ".md5anim");
  assimp::ReadOptions options;
  options.with_materials = with_materials;
  return with_its_files(assimp::read_file(file.path(), options), file, inputs);
}

bool is_scene(registry::Kind kind) {
  return format_of(kind).read_scene != nullptr;
}

Result<nodes::Scene> open_scene(const InputFile& file, Inputs& inputs, bool with_materials) {
  const Format& format = format_of(file);
  if (format.read_scene == nullptr) {
    return Error("scene-kind", "is not a scene: glTF, FBX, COLLADA, SMD, MS3D, 3DS, ASE or MD5")
        .in_file(file.path());
  }
  return format.read_scene(file, inputs, with_materials);
}

}  // namespace krok::io
