#pragma once

#include <string>
#include <string_view>

#include "core/result.h"

// Paths that a file from anyone names, which must not lead out of its folder.

namespace krok {

// What is wrong with a path as a name of a file in the folder tree of the file that names it, as
// words to follow it: "is not a relative path"; empty where nothing is. '/' parts it, on every
// system; an empty path, absolute ones, drive letters, URLs, backslashes, control characters,
// .., folders alone and texts that are not UTF-8 are none.
std::string path_fault(std::string_view path);

// Where such a file is: a path below `folder` ("" is the current one). An Error (code path-outside)
// for a path with a fault, and for one that leads out of the folder by a symbolic link. The file
// need not exist.
Result<std::string> path_inside(const std::string& folder, const std::string& path);

// The folder of a file, "." where its path has none.
std::string folder_of(const std::string& path);

}  // namespace krok
