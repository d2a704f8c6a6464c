#pragma once

#include <map>
#include <memory>
#include <string>

#include "formats/assimp/conversion_internal.h"
#include "scene/material.h"

namespace krok::assimp {

// A material's name; of those that Assimp named itself the picture's.
std::string material_name(const aiScene& source, unsigned index);

// Assimp's materials as ours, as far as it tells of them. Pictures that are in the file come with
// their bytes, others with the path that the file names. Run in the child.
class MaterialBuilder {
 public:
  explicit MaterialBuilder(Conversion& to) : to_(to) {}

  // The place in the scene's list of Assimp's material, which is added where it is new; -1 where
  // there is none.
  int index_of(unsigned material);

  // Warns of what was left out.
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
