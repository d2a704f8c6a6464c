#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "formats/registry/registry.h"

// Modifies files to work around bugs of Assimp 5.2 that would otherwise go unnoticed.

namespace krok::assimp {

// The text that Assimp reads instead, or an empty string if no change is needed. Code:
// assimp-refused for a faulty file that Assimp would accept.
Result<std::string> mend_input(registry::Kind kind, std::string_view text);

// UTF-16 text (by its byte-order mark) as UTF-8, up to what is not valid; empty if it is none.
// Assimp 5.2 leaves such text as it is.
std::string utf8_of(std::string_view text);

// The joints of an .md5mesh or .md5anim, one line each with name and parent; to check whether two
// files match.
std::string md5_joints(std::string_view text);

}  // namespace krok::assimp
