#pragma once

#include "formats/io/inputs.h"
#include "formats/registry/registry.h"
#include "nodes/scene.h"

// Scenes of nodes with characters, cameras and animations: glTF, and what is read through Assimp.

namespace krok::io {

bool is_scene(registry::Kind kind);

// Reads a scene, with materials and images on request. The other files that were read (buffers,
// images, companions) are opened by `inputs` too. The scene's diagnostics are left to the caller;
// they name the file. Standard input has no folder to find other files in.
//
// Errors: those of the reader; assimp-kind for standard input that is read through Assimp;
// scene-kind for a file that is not a scene.
Result<nodes::Scene> open_scene(const InputFile& file, Inputs& inputs, bool with_materials = false);

// The addresses of all motions of a file: FILE#ANIMATION for each animation that moves or poses
// joints, where a scene has several; else, and if it cannot be read, the path itself. Animations
// called ARMATURE|NAME are NAME where that says which, those whose name is no file name are
// numbers. A note (clip-still) names those that are left out.
std::vector<std::string> addresses_in(const std::string& path, const GivenLimits& limits,
                                      Diagnostics& notes);

}  // namespace krok::io
