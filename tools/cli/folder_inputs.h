#pragma once

#include <string>
#include <vector>

#include "core/result.h"

namespace krok::cli {

// Keeps those of a folder's files that have one of the endings, in lower case with the dot. Names
// and counts the others of known formats (code folder-left-out): a warning if one may hold a
// motion, else a note; nothing if there are none. What is read with the motion beside it, such as
// an Acclaim skeleton, does not count. Where the endings are those of motions, a capture beside the
// .anim of its name is left out, too (a warning, code folder-twice): the take would count twice.
Diagnostics keep_inputs(const std::string& folder, const std::vector<std::string>& endings,
                        std::vector<std::string>& paths);

}  // namespace krok::cli
