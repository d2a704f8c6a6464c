#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Patterns of file names, as shells have them: * and ? stand for any characters but /, [a-z] and
// [!a-z] for one of a set, ** as a whole part for any number of folders. Nothing stands for a dot
// at the beginning of a name. ** does not follow symbolic links to folders.

namespace krok {

bool has_wildcards(std::string_view text);

// Whether one part of a path, without /, fits one part of a pattern.
bool matches(std::string_view pattern, std::string_view name);

// The folders of a pattern before its first part with a wildcard: "a/b" for "a/b/*/c.bvh", "" for
// "*.bvh", "/" for "/*.bvh".
std::string fixed_part(const std::string& pattern);

// All files (no folders) that fit, as paths that begin as the pattern does, sorted by their bytes.
// An Error (code file-unreadable) for a folder that cannot be read; none found is no error.
Result<std::vector<std::string>> find_files(const std::string& pattern);

// All files in a folder and the folders in it, as `folder/**` finds them.
Result<std::vector<std::string>> find_files_below(const std::string& folder);

}  // namespace krok
