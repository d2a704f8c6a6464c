#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// File name patterns (globs) as in shells: * and ? match any characters except /, [a-z] and [!a-z]
// match one of a set, and ** as a whole path component matches any number of folders. A leading dot
// is never matched by a wildcard. ** does not follow symbolic links to folders.

namespace krok {

bool has_wildcards(std::string_view text);

// Whether a path component matches a pattern component.
bool matches(std::string_view pattern, std::string_view name);

// The folders of a pattern before its first component with a wildcard: "a/b" for "a/b/*/c.bvh", ""
// for "*.bvh", "/" for "/*.bvh".
std::string fixed_part(const std::string& pattern);

// All matching files (not folders), sorted bytewise; paths start as the pattern does. Fails (code
// file-unreadable) if a folder cannot be read. No match is not an error.
Result<std::vector<std::string>> find_files(const std::string& pattern);

// All files in a folder and its sub-folders, as for `folder/**`.
Result<std::vector<std::string>> find_files_below(const std::string& folder);

}  // namespace krok
