#include "tools/common/gltf/gltf_input.h"

#include <filesystem>

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

Result<nodes::Scene> read_gltf(const InputFile& input, ToolContext& context) {
  gltf::ReadOptions options;
  if (input.path() != "-") {
    const std::string folder = std::filesystem::path(input.path()).parent_path().string();
    options.folder = folder.empty() ? "." : folder;
  }
  return with_its_files(gltf::read(input.bytes(), options), input, context);
}

}  // namespace krok
