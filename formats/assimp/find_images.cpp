#include "formats/assimp/find_images_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "core/file.h"
#include "core/path_inside.h"
#include "core/text.h"

namespace krok::assimp {

namespace {

namespace fs = std::filesystem;

class ImageFinder {
 public:
  ImageFinder(const std::string& path, std::uint64_t most_bytes, nodes::Scene& scene)
      : folder_(folder_of(path)), bytes_left_(most_bytes), scene_(scene) {}

  void fill_in(Texture& texture) {
    if (!texture) return;
    const auto [place, added] = known_.try_emplace(texture.image);
    if (added) place->second = found(*texture.image);
    if (place->second == nullptr) {
      texture = Texture();
    } else {
      texture.image = place->second;
    }
  }

 private:
  using Shared = std::shared_ptr<const EncodedImage>;

  Shared found(const EncodedImage& named) {
    EncodedImage image = named;
    if (image.bytes.empty()) {
      auto file = open(image.path);
      if (!file) return warn(named, "is not in the file's folder", "copy it there");
      image.path = file->path();
      image.bytes.assign(file->bytes().begin(), file->bytes().end());
      bytes_left_ -= std::min<std::uint64_t>(bytes_left_, image.bytes.size());
    }
    const auto facts = image_info(image.bytes);
    if (!facts) {
      return warn(named, "cannot be used: " + facts.error().message, facts.error().hint);
    }
    if (named.bytes.empty()) scene_.files.push_back(image.path);
    return std::make_shared<const EncodedImage>(std::move(image));
  }

  Shared warn(const EncodedImage& image, const std::string& why, const std::string& hint) {
    Diagnostic warning;
    warning.severity = Severity::warning;
    warning.code = "assimp-picture";
    std::string path = image.path;
    std::replace(path.begin(), path.end(), '\\', '/');
    warning.message = fmt::format("the image '{}' {}; it is left out", shown(base_name(path)), why);
    warning.hint = hint;
    scene_.diagnostics.push_back(std::move(warning));
    return nullptr;
  }

  std::optional<InputFile> open(std::string name) const {
    std::replace(name.begin(), name.end(), '\\', '/');
    while (name.starts_with("./")) name.erase(0, 2);
    const std::string base = base_name(name);
    std::vector<std::string> candidates = {name, base, "textures/" + base};
    for (const char* folder : {"", "textures/"}) {
      for (const std::string& other : same_but_for_case(folder, base)) candidates.push_back(other);
    }
    for (const std::string& candidate : candidates) {
      const auto path = path_inside(folder_, candidate);
      std::error_code trouble;
      if (!path || !fs::is_regular_file(*path, trouble)) continue;
      auto file = InputFile::open(*path, bytes_left_);
      if (file) return *std::move(file);
    }
    return std::nullopt;
  }

  // Most of these formats come from systems with case-insensitive file names.
  std::vector<std::string> same_but_for_case(const std::string& below,
                                             const std::string& base) const {
    std::vector<std::string> found;
    std::error_code trouble;
    for (fs::directory_iterator entry(fs::path(folder_) / below, trouble), end;
         !trouble && entry != end; entry.increment(trouble)) {
      const std::string name = entry->path().filename().string();
      if (same_word(name, base)) found.push_back(below + name);
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  const std::string folder_;
  std::uint64_t bytes_left_;
  nodes::Scene& scene_;
  std::map<Shared, Shared> known_;
};

}  // namespace

void find_images(const std::string& path, std::uint64_t most_bytes, nodes::Scene& scene) {
  ImageFinder finder(path, most_bytes, scene);
  for (Material& material : scene.materials) {
    for (Texture* texture : textures_of(material)) finder.fill_in(*texture);
    // In these formats an image replaces the colour.
    if (material.base_color_texture) material.base_color.head<3>().setOnes();
    if (material.emissive_texture) material.emissive.setOnes();
  }
}

}  // namespace krok::assimp
