#pragma once

#include "formats/assimp/collada_text_internal.h"
#include "nodes/scene.h"

namespace krok::assimp {

// Gives the animation the clip's name, and where the clip says its time only that part, from 0 on.
void shape_clip(const ColladaClip& clip, nodes::Animation& animation);

}  // namespace krok::assimp
