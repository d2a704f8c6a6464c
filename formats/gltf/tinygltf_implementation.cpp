// Compiles tinygltf's implementation; its options are set in CMakeLists.txt.

#define TINYGLTF_IMPLEMENTATION
// First, so that the JSON library that tinygltf uses is not instantiated here again.
#include "core/json_internal.h"

#include <tiny_gltf.h>
