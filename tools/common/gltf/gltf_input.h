#pragma once

#include "core/file.h"
#include "core/result.h"
#include "nodes/scene.h"
#include "tools/common/tool.h"

namespace krok {

// Notes as inputs of the run the files that a scene was read from besides `input`: buffers, images.
// What the reader found odd gets the place of the file.
Result<nodes::Scene> with_its_files(Result<nodes::Scene> scene, const InputFile& input,
                                    ToolContext& context);

// Reads glTF, of both kinds, with the files in its folder that it refers to; materials and pictures
// where they are asked for. What the reader found odd is left in the scene's diagnostics. Standard
// input holds no folder to find other files in.
Result<nodes::Scene> read_gltf(const InputFile& input, ToolContext& context,
                               bool with_materials = false);

}  // namespace krok
