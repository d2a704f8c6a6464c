#include "tools/krok-view/ragdoll_bodies.h"

#include "formats/ragdoll/ragdoll_format.h"
#include "ragdoll/body_meshes.h"

namespace krok::cli::view {

namespace {

const Material& translucent() {
  static const Material kMaterial = [] {
    Material material;
    material.name = "bodies";
    material.base_color = Vec4f(0.35f, 0.6f, 0.85f, 0.45f);
    material.alpha = Material::Alpha::blend;
    return material;
  }();
  return kMaterial;
}

}  // namespace

Status show_ragdoll_bodies(const std::string& path, ToolContext& context, Files& files) {
  if (path.empty()) return {};
  if (files.motions.empty()) {
    return Error("usage", "--bodies needs a motion", "give the .anim that krok-ragdoll wrote");
  }
  const auto file = context.open_input(path);
  if (!file) return file.error();
  for (Files::Motion& motion : files.motions) {
    const auto read = ragdoll_file::read(file->text(), &motion.clip.skeleton);
    if (!read) return Error(read.error()).in_file(path);
    files.bodies.push_back(krok::ragdoll::body_meshes(motion.clip.skeleton, read->bodies));
    motion.body = &files.bodies.back();
    motion.materials = {&translucent(), 1};
  }
  return {};
}

}  // namespace krok::cli::view
