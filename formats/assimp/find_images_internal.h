#pragma once

#include <cstdint>
#include <string>

#include "nodes/scene.h"

namespace krok::assimp {

// Finds the pictures that the scene's materials name without having them: in the folder tree of the
// file at `path`, under the path that the file names or the base name alone (in any case of
// letters), beside the file or in a folder "textures" there; a picture takes the place of the
// colour that the file has too. Those that are neither there nor sound are taken out, with a
// warning (code assimp-picture). No more than `most_bytes` are read. Paths of what was read are
// added to the scene's files.
void find_images(const std::string& path, std::uint64_t most_bytes, nodes::Scene& scene);

}  // namespace krok::assimp
