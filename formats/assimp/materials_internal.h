#pragma once

#include <map>
#include <memory>
#include <string>

#include "formats/assimp/conversion_internal.h"
#include "scene/material.h"

namespace krok::assimp {

// A material's name; its image's name if Assimp made the name up.
std::string material_name(const aiScene& source, unsigned index);

// Converts Assimp's materials. Embedded images have their bytes, others the path in the file. Runs
// in the child process.
class MaterialBuilder {
 public:
  explicit MaterialBuilder(Conversion& to) : to_(to) {}

  // Index in the scene of one of Assimp's materials, added if new; -1 for none.
  int index_of(unsigned material);

  // Warns about what was left out.
  void report();

 private:
  Material convert(const aiMaterial& source);
  Texture texture(const aiMaterial& source, aiTextureType type);
  Texture first_texture(const aiMaterial& source, std::initializer_list<aiTextureType> types);
  std::shared_ptr<const EncodedImage> image(const std::string& path);

  Conversion& to_;
  std::map<unsigned, int> places_;
  std::map<std::string, std::shared_ptr<const EncodedImage>> images_;  // by path
  std::size_t other_coordinates_ = 0, undecoded_ = 0, separate_ = 0;
};

}  // namespace krok::assimp
