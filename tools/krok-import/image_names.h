#pragma once

#include <set>
#include <string>

#include "scene/encoded_image.h"

namespace krok::cli::import {

// Creates file names for images in their own folder.
class ImageNames {
 public:
  // The image's name, or `fallback` ("Skin_normal") if it has none, with the extension of its kind.
  // Always valid on common file systems and unique, ignoring case.
  std::string make(const EncodedImage& image, ImageKind kind, const std::string& fallback);

 private:
  std::set<std::string> taken_;  // in lower case
};

}  // namespace krok::cli::import
