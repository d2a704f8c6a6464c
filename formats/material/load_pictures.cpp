#include <map>

#include "formats/material/material_format.h"

namespace krok::material {

Status load_pictures(std::span<Material> materials, const OpenPicture& open) {
  std::map<std::string, std::shared_ptr<const Picture>> loaded;  // by path
  for (Material& material : materials) {
    for (Texture* texture : textures_of(material)) {
      if (!*texture) continue;
      const std::string& path = texture->picture->path;
      std::shared_ptr<const Picture>& picture = loaded[path];
      if (picture == nullptr) {
        const auto file = open(path);
        if (!file) return file.error();
        auto facts = picture_facts(file->bytes());
        if (!facts) return std::move(facts.error()).in_file(file->path());
        picture = std::make_shared<const Picture>(
            Picture{texture->picture->name, path, {file->bytes().begin(), file->bytes().end()}});
      }
      texture->picture = picture;
    }
  }
  return {};
}

}  // namespace krok::material
