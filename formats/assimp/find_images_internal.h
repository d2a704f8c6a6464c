#pragma once

#include <cstdint>
#include <string>

#include "nodes/scene.h"

namespace krok::assimp {

// Loads images that the scene's materials reference but that are not embedded. Searches the folder
// tree of the file at `path` for the referenced path, then the file's folder and its subfolder
// "textures" for the base name, ignoring case. An image replaces the material's base colour.
// Missing and invalid images are removed, with a warning (code assimp-picture). Reads at most
// `most_bytes`. Adds the paths of the images to the scene's files.
void find_images(const std::string& path, std::uint64_t most_bytes, nodes::Scene& scene);

}  // namespace krok::assimp
