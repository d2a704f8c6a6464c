#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Which files of a folder are compared.

namespace krok::diff {

// Patterns as a shell has them. One without a slash is held against names alone, "*.glb"; one with
// a slash against the path below the folder, "walks/**/*.glb". No `include` is all files.
struct PathFilter {
  std::vector<std::string> include, exclude;

  bool takes(const std::string& path) const;
};

// Whether a path fits a pattern; ** as a whole part stands for any number of folders.
bool path_fits(std::string_view pattern, std::string_view path);

struct FolderFiles {
  std::vector<std::string> paths;  // below the folder, sorted by their bytes
  std::vector<std::string> notes;  // what was left out, sentences for people
};

// The files in a folder and in its sub-folders. Left out are names that begin with a dot, journals
// of batches (krok-import.journal.jsonl), what the filter does not take, the folder `other` and the
// files `written` where they lie inside; with a note links to folders (so that loops end) and
// devices and pipes (so that nothing waits). An Error (code file-unreadable) for a folder that
// cannot be searched.
Result<FolderFiles> files_in(const std::string& folder, const PathFilter& filter,
                             const std::string& other, const std::vector<std::string>& written);

}  // namespace krok::diff
