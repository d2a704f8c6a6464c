#pragma once

#include "formats/assimp/collada_text_internal.h"
#include "nodes/scene.h"

namespace krok::assimp {

// Sets the animation's name to the clip's and, if the clip has a time range, trims the animation to
// it, starting at 0.
void shape_clip(const ColladaClip& clip, nodes::Animation& animation);

}  // namespace krok::assimp
