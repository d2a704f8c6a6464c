#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Selects the files of a folder to compare.

namespace krok::cli::diff {

// Shell patterns. Without a slash they match file names, "*.glb"; with a slash, paths relative to
// the folder, "walks/**/*.glb". An empty `include` matches all files.
struct PathFilter {
  std::vector<std::string> include, exclude;

  bool takes(const std::string& path) const;
};

// Whether a path matches a pattern; ** as a path component matches any number of folders.
bool path_fits(std::string_view pattern, std::string_view path);

struct FolderFiles {
  std::vector<std::string> paths;  // relative to the folder, sorted bytewise
  std::vector<std::string> notes;  // messages about skipped files
};

// The files in a folder and its sub-folders. Skipped silently: names that begin with a dot, batch
// journals (krok-import.journal.jsonl), files that the filter excludes, and the folder `other` and
// the files `written` if they are inside. Skipped with a note: links to folders (which could form
// loops), devices and pipes (which could block). Error (code file-unreadable) for a folder that
// cannot be read.
Result<FolderFiles> files_in(const std::string& folder, const PathFilter& filter,
                             const std::string& other, const std::vector<std::string>& written);

}  // namespace krok::cli::diff
