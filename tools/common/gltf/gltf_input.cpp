#include "tools/common/gltf/gltf_input.h"

#include "core/path_inside.h"
#include "formats/gltf/gltf_reader.h"

namespace krok {

Result<nodes::Scene> with_its_files(Result<nodes::Scene> scene, const InputFile& input,
                                    ToolContext& context) {
  if (!scene) return std::move(scene.error()).in_file(input.path());
  for (const std::string& path : scene->files) {
    if (path == input.path()) continue;
    if (const auto other = context.open_input(path); !other) return other.error();
  }
  for (Diagnostic& diagnostic : scene->diagnostics) {
    if (diagnostic.where.file.empty()) diagnostic.where.file = input.path();
  }
  return scene;
}

Result<nodes::Scene> read_gltf(const InputFile& input, ToolContext& context, bool with_materials) {
  gltf::ReadOptions options;
  options.with_materials = with_materials;
  if (input.path() != "-") options.folder = folder_of(input.path());
  return with_its_files(gltf::read(input.bytes(), options), input, context);
}

}  // namespace krok
