#include "tools/cli/new_folders.h"

#include <fmt/format.h>

#include <filesystem>

namespace krok::cli {

namespace fs = std::filesystem;

NewFolders::~NewFolders() {
  std::error_code ignored;
  // Only empty folders are removed.
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) fs::remove(*folder, ignored);
}

Status NewFolders::make(const std::string& folder) {
  std::error_code trouble;
  std::vector<fs::path> missing;
  for (fs::path path = folder; !path.empty() && !fs::exists(path, trouble);
       path = path.parent_path()) {
    missing.push_back(path);
  }
  trouble.clear();
  for (auto path = missing.rbegin(); path != missing.rend() && !trouble; ++path) {
    if (fs::create_directory(*path, trouble)) made_.push_back(path->string());
  }
  if (!trouble && fs::is_directory(folder, trouble)) return {};
  return Error("file-unwritable", fmt::format("cannot create folder: {}",
                                              trouble ? trouble.message() : "a file has this name"))
      .in_file(folder);
}

}  // namespace krok::cli
