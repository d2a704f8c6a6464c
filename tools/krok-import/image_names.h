#pragma once

#include <set>
#include <string>

#include "scene/encoded_image.h"

namespace krok::import {

// Names for the files that pictures are written to, in a folder of their own.
class ImageNames {
 public:
  // A name as the picture has it, or as `fallback` ("Skin_normal") where it has none, with the
  // ending of its kind. Whatever the names are, it is one that file systems take, and no two are
  // the same in any case of letters.
  std::string make(const EncodedImage& image, ImageKind kind, const std::string& fallback);

 private:
  std::set<std::string> taken_;  // in lower case
};

}  // namespace krok::import
