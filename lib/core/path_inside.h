#pragma once

#include <string>
#include <string_view>

#include "core/result.h"

// Checks paths in files from untrusted sources, which must not lead out of the file's folder.

namespace krok {

// Why `path` is invalid as the path of a file in the folder tree of the file that refers to it,
// worded to follow the path: "is not a relative path"; empty if it is valid. The separator is '/'
// on every system. Invalid are empty, absolute and overlong paths, drive letters, URLs,
// backslashes, control characters, .., paths of folders, and text that is not UTF-8.
std::string path_fault(std::string_view path);

// The path of such a file below `folder` ("" is the current folder). An Error (code path-outside)
// if path_fault() finds a fault or if a symbolic link leads out of the folder. The file need not
// exist.
Result<std::string> path_inside(const std::string& folder, const std::string& path);

// The folder of a file, "." if its path has none.
std::string folder_of(const std::string& path);

}  // namespace krok
