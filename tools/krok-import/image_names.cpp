#include "tools/krok-import/image_names.h"

#include <algorithm>

#include "core/file.h"
#include "core/text.h"
#include "tools/cli/file_name.h"

namespace krok::cli::import {

namespace {

// Removes the extension of an image file.
std::string without_ending(const std::string& name) {
  const std::string ending = extension(name);
  for (const char* known : {".png", ".jpg", ".jpeg", ".jpe", ".tga", ".bmp", ".tif", ".dds"}) {
    if (ending == known) return name.substr(0, name.size() - ending.size());
  }
  return name;
}

}  // namespace

std::string ImageNames::make(const EncodedImage& image, ImageKind kind,
                             const std::string& fallback) {
  std::string path = image.path.empty() ? image.name : image.path;
  std::replace(path.begin(), path.end(), '\\', '/');
  std::string stem = without_ending(to_utf8(base_name(path)));
  std::replace(stem.begin(), stem.end(), ' ', '_');
  if (stem.empty()) stem = fallback;
  stem = file_name_of(stem);
  while (stem.ends_with('.')) stem.pop_back();
  if (stem.empty()) stem = "picture";
  std::string name = stem;
  for (int number = 2; !taken_.insert(ascii_lower(name)).second; ++number) {
    name = stem + "_" + std::to_string(number);
  }
  return name + std::string(extension_of(kind));
}

}  // namespace krok::cli::import
