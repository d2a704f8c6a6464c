// The one place where tinygltf's code is compiled; its options stand in CMakeLists.txt.

#define TINYGLTF_IMPLEMENTATION
// First, so that the JSON that tinygltf uses is not compiled here once more.
#include "core/json_internal.h"

#include <tiny_gltf.h>
