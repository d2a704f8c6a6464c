#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "formats/registry/registry.h"

// What must be changed in a file before Assimp 5.2 reads it right. Each is a fault of Assimp's that
// would go unnoticed.

namespace krok::assimp {

// The text that Assimp is to read instead, or an empty string where the file is fine as it is. An
// Error (code assimp-refused) where the file has a fault that Assimp would read over.
Result<std::string> mend_input(registry::Kind kind, std::string_view text);

// The joints of an .md5mesh or .md5anim, a line each: name and parent. For telling whether two
// belong together.
std::string md5_joints(std::string_view text);

}  // namespace krok::assimp
