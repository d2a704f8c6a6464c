#include <map>

#include "formats/material/material_format.h"

namespace krok::material {

Status load_images(std::span<Material> materials, const OpenImage& open) {
  std::map<std::string, std::shared_ptr<const EncodedImage>> loaded;  // by path
  for (Material& material : materials) {
    for (Texture* texture : textures_of(material)) {
      if (!*texture) continue;
      const std::string& path = texture->image->path;
      std::shared_ptr<const EncodedImage>& image = loaded[path];
      if (image == nullptr) {
        const auto file = open(path);
        if (!file) return file.error();
        auto facts = image_info(file->bytes());
        if (!facts) return std::move(facts.error()).in_file(file->path());
        image = std::make_shared<const EncodedImage>(
            EncodedImage{texture->image->name, path, {file->bytes().begin(), file->bytes().end()}});
      }
      texture->image = image;
    }
  }
  return {};
}

}  // namespace krok::material
