#pragma once

#include "core/file.h"
#include "core/result.h"
#include "formats/registry/registry.h"
#include "nodes/scene.h"
#include "tools/common/tool.h"

namespace krok {

// Whether a file of this kind is a scene of nodes, with characters, cameras and animations, and no
// capture: glTF, and what is read through Assimp.
bool is_scene(registry::Kind kind);

// Reads a scene, with materials and pictures where they are asked for. The files that were read
// besides `input` become inputs of the run too. What the reader found odd is left in the scene's
// diagnostics, with the place of the file. Standard input holds no folder to find other files in,
// and nothing that is read through Assimp (code assimp-kind).
Result<nodes::Scene> read_scene(const InputFile& input, registry::Kind kind, ToolContext& context,
                                bool with_materials = false);

}  // namespace krok
