// The one place where tinygltf's code is compiled; its options stand in CMakeLists.txt.

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
